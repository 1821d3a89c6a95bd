#pragma once

#include <optional>
#include <vector>

#include "bespoke/rbf/point_grid.h"
#include "bespoke/types.h"

namespace bespoke {

/// A point of a cloud as a piece of the surface.
struct SurfaceElement {
  Vector3 point;
  Vector3 normal;  ///< unit
  double reach;    ///< where its weight ends, > 0, mesh units
};

/// What the elements near a place say of the surface.
struct SurfaceEstimate {
  double distance;    ///< signed, positive outside, mesh units; rough away from the surface
  Vector3 normal;     ///< unit
  double off_centre;  ///< from the weighted mean of the elements' points, in units of their mean reach
  double nearest;     ///< distance of the nearest such point, in units of its reach
};

/// The surface f = 0 of moving least squares through oriented points,
///   f(x) = Σ wᵢ ½ (nᵢ + n) · (x − pᵢ) / Σ wᵢ,   n = Σ wᵢ nᵢ / |Σ wᵢ nᵢ|,   wᵢ = (1 − |x − pᵢ|²/hᵢ²)⁴ c:
/// the mean of Kolluri's (2005, nᵢ), outside a convex surface by h²κ/8, and Adamson and Alexa's (2003, n), as
/// far inside. c = max(0, nᵢ · m), m the weighted mean without c, separates sheets that face away from each
/// other (as Öztireli, Guennebaud, Gross 2009).
class MovingSurface {
 public:
  /// The elements must outlive it, in an order that is their own.
  MovingSurface(const std::vector<SurfaceElement>& elements, const Points& points);

  double largest_reach() const { return largest_reach_; }

  /// The elements that may reach a place within `radius` of `center`, in the order of the grid.
  void gather(const Vector3& center, double radius, std::vector<int>& near) const;

  /// Empty where none of the elements reaches. Thread-safe.
  std::optional<SurfaceEstimate> estimate(const Vector3& x, const std::vector<int>& near) const;

 private:
  Vector3 facing(const Vector3& x, const std::vector<int>& near) const;

  const std::vector<SurfaceElement>& elements_;
  double largest_reach_;
  PointGrid grid_;
};

}  // namespace bespoke
