#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "bespoke/anchors/anchor_accuracy.h"

namespace bespoke {

/// Lays the source without these pairs (numbers among those given) and answers those of them that it puts
/// elsewhere.
using RejectAnchors = std::function<std::vector<RejectedAnchor>(const std::vector<std::size_t>& left_out)>;

/// Of the doubted pairs those that surfaces laid by all the others put elsewhere. A right pair may come to
/// lie elsewhere because its neighbours were left out with it, as a heel does without the ankle: pairs that
/// the surfaces confirm are taken back and the rest is asked for again, until none is confirmed.
std::vector<RejectedAnchor> rejected_anchors(std::vector<std::size_t> suspects, const RejectAnchors& reject);

/// Of pairs disowned together the numbers of those that surfaces laid with all the others put elsewhere.
std::vector<std::size_t> rejected_alone(const std::vector<RejectedAnchor>& together,
                                        const RejectAnchors& reject);

/// Whether this pair is right after all: lays the source without the others alone.
using ReinstateAnchor = std::function<bool(std::size_t anchor, const std::vector<std::size_t>& others)>;

/// Of disowned pairs those that are not taken back. Each is asked for once, the nearest to where the surfaces
/// put it first; what is taken back is not among the others of the next.
std::vector<RejectedAnchor> not_reinstated(const std::vector<RejectedAnchor>& rejected,
                                           const ReinstateAnchor& reinstate);

}  // namespace bespoke
