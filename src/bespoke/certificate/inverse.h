#pragma once

#include <memory>
#include <vector>

#include "bespoke/lattice/baked_map.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// E⁻¹ of a baked map, point by point: damped Newton steps through the trilinear cells, and where these stall
/// a search of all cells whose image may hold the point, which cannot miss it when the map is a bijection
/// (Certificate::is_bijection). Thread-safe.
class PointwiseInverse {
 public:
  /// `map` must outlive the inverse. Throws InvalidInput when the affine part is singular.
  explicit PointwiseInverse(const BakedMap& map);
  ~PointwiseInverse();

  /// x with E(x) = y for the columns of y (3×n, source frame, mesh units), to 1e-6 of the finest voxel.
  /// Throws SolverError, naming the first point and its residual, when a point has no preimage to be found;
  /// InvalidInput for points that are not finite.
  Points operator()(const Points& y) const;

 private:
  struct Cells;
  Points preimages(const Points& y) const;
  void search_cells(const Points& y, const std::vector<Eigen::Index>& columns, Points& x) const;

  const BakedMap& map_;
  Matrix3 inverse_linear_;
  double tolerance_;  // of |E(x) − y|, mesh units
  std::unique_ptr<const Cells> cells_;
};

/// The inverse of Ψ = Γ∘E as an elastic map, to be baked: Γ∘E⁻¹∘Γ⁻¹ in the target frame, so that
/// Ψ⁻¹ = Γ⁻¹∘(Γ∘E⁻¹∘Γ⁻¹). Exactly affine outside the image of E's support.
class InverseMap : public ElasticMap {
 public:
  /// `map` must outlive the inverse.
  InverseMap(const BakedMap& map, const RigidTransform& target_from_source);

  AffineMap affine() const override;
  Points displacement(const Points& x) const override;
  Points displacement_gradient(const Points& x) const override;
  Support support() const override;

 private:
  const BakedMap& map_;
  PointwiseInverse inverse_;
  RigidTransform target_from_source_;
};

}  // namespace bespoke
