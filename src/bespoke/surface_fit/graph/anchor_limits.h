#pragma once

#include <vector>

#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/types.h"

namespace bespoke {

/// What the nodes' fit knows of its accuracy before a solve, diagonals.
struct FitState {
  const Eigen::VectorXd& anchor_residuals;  ///< k: of the anchors from their targets now
  double pair_distance = 0;                 ///< median of the surface's pairs; 0: none were found
  double smoothing = 0;                     ///< ℓ
};

/// Bounds the weight of anchors of limited accuracy. A stretch of surface ℓ wide has the share ℓ²/A of its
/// weight and is off by the distance m of its pairs, by τ (settings) along the surface, an anchor by σ; by
/// maximum likelihood (inverse variances)  w ≤ ℓ²/A · (κ m² + τ²) / σ²,  so anchors lead while surfaces are
/// far apart. κ ≥ 1 grows while the median residual along the surface exceeds that of normal errors of
/// deviation σ: the surface has slid farther than m shows. Not thread-safe.
class AnchorLimits {
 public:
  /// sigmas: k, ≥ 0, diagonals; area: of the surface, diagonals squared.
  AnchorLimits(Eigen::VectorXd sigmas, double area, const AnchorSettings& settings);

  /// k: the largest weight of each anchor, beside that of the whole surface; infinite where σ is 0 and while
  /// there are no pairs.
  std::vector<double> next(const FitState& state);

 private:
  void reinforce(const Eigen::VectorXd& residuals);

  Eigen::VectorXd sigmas_;
  double area_;
  AnchorSettings settings_;
  double reinforcement_ = 1;  // κ
};

}  // namespace bespoke
