#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "bespoke/anchors/anchor_accuracy.h"

namespace bespoke {

/// Lays the source without these pairs (numbers among those given) and answers those of them that it puts
/// elsewhere.
using DisownAnchors = std::function<std::vector<LeftOutAnchor>(const std::vector<std::size_t>& left_out)>;

/// Of the doubted pairs those that surfaces laid by all the others put elsewhere. A right pair may come to
/// lie elsewhere because its neighbours were left out with it, as a heel does without the ankle: pairs that
/// the surfaces confirm are taken back and the rest is asked for again, until none is confirmed.
std::vector<LeftOutAnchor> disowned_anchors(std::vector<std::size_t> doubted, const DisownAnchors& disown);

/// Of pairs disowned together the numbers of those that surfaces laid with all the others put elsewhere.
std::vector<std::size_t> disowned_alone(const std::vector<LeftOutAnchor>& together,
                                        const DisownAnchors& disown);

/// Whether this pair is right after all: lays the source without the others alone.
using TakeBackAnchor = std::function<bool(std::size_t anchor, const std::vector<std::size_t>& others)>;

/// Of disowned pairs those that are not taken back. Each is asked for once, the nearest to where the surfaces
/// put it first; what is taken back is not among the others of the next.
std::vector<LeftOutAnchor> not_taken_back(const std::vector<LeftOutAnchor>& disowned,
                                          const TakeBackAnchor& take_back);

}  // namespace bespoke
