#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "bespoke/anchors/anchor_accuracy.h"

namespace bespoke {

/// Registers the source without these pairs (numbers among those given) and returns those of them that it
/// puts elsewhere.
using RejectAnchors = std::function<std::vector<RejectedAnchor>(const std::vector<std::size_t>& left_out)>;

/// Of the suspect pairs those that surfaces registered by all the others displace. A right pair may come to
/// lie elsewhere because its neighbours were left out with it, as a heel does without the ankle: pairs that
/// the surfaces confirm are reset and the rest is requested again, until none is confirmed.
std::vector<RejectedAnchor> rejected_anchors(std::vector<std::size_t> suspects, const RejectAnchors& reject);

/// Of pairs rejected together the numbers of those that surfaces registered with all the others displace.
std::vector<std::size_t> rejected_alone(const std::vector<RejectedAnchor>& together,
                                        const RejectAnchors& reject);

/// Whether this pair is right after all: registers the source without the others alone.
using ReinstateAnchor = std::function<bool(std::size_t anchor, const std::vector<std::size_t>& others)>;

/// Of rejected pairs those that are not reset. Each is requested once, the nearest to where the surfaces
/// put it first; what is reset is not among the others of the next.
std::vector<RejectedAnchor> not_reinstated(const std::vector<RejectedAnchor>& rejected,
                                           const ReinstateAnchor& reinstate);

}  // namespace bespoke
