#pragma once

#include <memory>

#include "bespoke/flow/regional_motion.h"

namespace bespoke {

/// Surfaces between a source and the fitted source on which limbs keep their length: the rotation and the
/// stretch of every face's gradient are interpolated, rotations along neighbours so that they may exceed
/// 180°, and the surface whose edges come closest is found by a Poisson equation (Xu, Zhang, Wang, Bao 2005).
/// Vertices at one place of the source move as one until their fitted places part. Pieces that no edge
/// connects (eyes, teeth), and vertices of no face, move with the surface next to them.
class SurfacePath {
 public:
  /// fitted: 3×n, the source's vertices on the target, source frame, mesh units: the whole's rigid motion
  /// should have been removed. Throws InvalidInput (sizes, values that are not finite, a source without
  /// area), SolverError.
  SurfacePath(const TriangleMesh& source, const Points& fitted);
  ~SurfacePath();
  SurfacePath(SurfacePath&&) noexcept;

  /// 3×n, t in [0, 1]; the source's vertices at 0 and the fitted ones at 1, exactly.
  Points at(double t) const;

  /// Of the regions along the path: turns may exceed π.
  RegionalMotion motion() const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace bespoke
