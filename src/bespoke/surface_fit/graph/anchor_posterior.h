#pragma once

#include <vector>

#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/types.h"

namespace bespoke {

/// Which anchors are to be tested, and against what. Lengths in diagonals.
struct TestedAnchors {
  std::vector<char> tested;  ///< k: whether it may be an outlier; empty: none may
  Eigen::VectorXd sigmas;    ///< k, ≥ 0; empty is 0 for all
  double area = 0;           ///< of the surface
};

/// Each anchor against what the others say of its place. In a fit, one Gauss-Newton step from that with all:
/// the residual over one less its leverage (Cook, Weisberg 1982). In a pose, by distances along the surfaces
/// (anchor_geodesics.h).
struct LeftOutAnchors {
  Eigen::VectorXd distances;    ///< k: of the target from where the others put the source, diagonals
  Eigen::VectorXd compliances;  ///< k, > 0: how freely the source moves there without it; of any one unit
};

/// How probably each anchor is an inlier: a mixture of anchors that lie normally distributed about where the
/// others and the surfaces put them, and of outliers, which lie anywhere on the surface,
///   p_k = (1 − ε) N(e_k; v_k) / ((1 − ε) N(e_k; v_k) + ε / A),  v_k = s² c_k + σ_k²,
/// e and c as LeftOutAnchors has them: the predictive distribution of a linear Gaussian model, whose scale s²
/// is by the median of e² / c. v has a floor. Expectation maximisation (Dempster, Laird, Rubin 1977) with the
/// fit as its other half. Not thread-safe.
class AnchorPosterior {
 public:
  AnchorPosterior(TestedAnchors anchors, const OutlierAnchorSettings& settings);

  /// Whether enough anchors are tested for the others to tell.
  bool is_active() const { return active_; }
  /// Where more than a third would be outliers, the mixture tells nothing: all stay.
  void update(const LeftOutAnchors& left_out);
  /// k; all 1 before the first update.
  const std::vector<double>& inliers() const { return inliers_; }
  /// The probable outliers, ascending.
  std::vector<Eigen::Index> outliers() const;

 private:
  TestedAnchors anchors_;
  OutlierAnchorSettings settings_;
  bool active_ = false;
  std::vector<double> inliers_;
};

}  // namespace bespoke
