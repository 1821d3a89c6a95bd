#pragma once

#include <vector>

#include "bespoke/anchors/anchor_accuracy.h"
#include "bespoke/progress.h"
#include "bespoke/registration/fit_summary.h"
#include "bespoke/registration/problem.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// Weighted pairs of points as matrices: 3×k, 3×k, k and k.
struct PointPairs {
  Points sources;
  Points targets;
  Eigen::VectorXd weights;
  Eigen::VectorXd sigmas;
};

/// Where anchors bring the source (IV.A, IV.B).
struct AnchorAlignment {
  RigidTransform target_from_source;  ///< Γ
  TriangleMesh target;                ///< H'_b: in the source frame, as all below
  Points warped;                      ///< Ẽ of the source's vertices, 3×n
  PointPairs pairs;  ///< those that lead the registration: the anchors and what else was given
  RigidSummary rigid;
  CoarseSummary coarse;
};

/// Γ by the estimated anchors, those of curves included; Ẽ by these and by `leading`, pairs of places without
/// anchors. Throws InvalidInput for anchors from which no fit follows, and as start_by_anchors.
AnchorAlignment align_by_anchors(const Problem& problem, const EstimatedAnchors& estimated,
                                 const std::vector<AnchorPair>& leading, const Progress& progress);

}  // namespace bespoke
