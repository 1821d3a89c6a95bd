#pragma once

#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/registration/detail/matched_parts.h"

namespace bespoke {

/// Models whose parts were matched.
struct MatchedModels {
  const TriangleMesh& source;
  const Points& placed;  ///< 3×n: the source's vertices on the target
  const TriangleMesh& target;
  const MatchedParts& parts;
};

/// Pairs that lead parts without an anchor of their own to their counterparts, whose surfaces may be too far
/// apart to find each other: vertices spread over a part, moved by the affine map that takes its mean and
/// covariance to those of the counterpart (optimal transport of normal distributions, Dowson & Landau 1982),
/// then to the closest points there. anchor_sources: 3×k, mesh units. σ is 1 % of the target's diagonal.
std::vector<AnchorPair> part_pairs(const MatchedModels& models, const Points& anchor_sources);

}  // namespace bespoke
