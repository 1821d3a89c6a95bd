#pragma once

#include "bespoke/types.h"

namespace bespoke {

/// The coarse warp Ẽ (IV.B, Eq. 7–10): Σ cᵢ |x − qᵢ|³ + a₀ + A x, interpolating or, with finite weights,
/// smoothing.
class GlobalRbf {
 public:
  /// Ẽ(sources) = targets for infinite weights; a finite weight w adds 1/w to the diagonal entry (mesh
  /// units³), scaled by the cube of the sources' bounding-box diagonal, so that w has no unit. sources,
  /// targets: 3×n; weights: n, > 0. The system is symmetric indefinite (the paper says positive definite), so
  /// it is solved in the null space of the affine tail, where it is definite. Throws InvalidInput for fewer
  /// than 4 pairs, duplicates, or (nearly) coplanar sources, naming the deficient direction.
  GlobalRbf(const Points& sources, const Points& targets, const Eigen::VectorXd& weights);

  /// 3×n → 3×n, mesh units.
  Points operator()(const Points& x) const;

  /// The affine tail.
  const AffineMap& affine() const { return affine_; }

 private:
  Points centers_;
  Points coefficients_;  // 3×n
  AffineMap affine_;
};

}  // namespace bespoke
