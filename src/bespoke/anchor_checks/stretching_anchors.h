#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/anchors/anchor_accuracy.h"
#include "bespoke/anchors/anchors.h"

namespace bespoke {

/// What contradicting exact pairs have to give way by: of two whose targets are farther apart, or nearer to
/// each other, than their sources by more than the factor `max_stretch` (> 1, beside the ratio of the sizes
/// of all pairs), each half of the difference, as σ, mesh units on the target. Differences below 0.1 % of the
/// targets' diagonal in every coordinate are remeshing. One a pair, 0 for pairs that contradict none, and for
/// those that are not exact, or that contradict half of the others: these are astray, and nobody shares
/// their blame. Of the first `count` pairs.
std::vector<double> sigmas_within_stretch(const Anchors& anchors, std::size_t count, double max_stretch);

/// Gives such pairs of the first `given` these σ, and names them in the accuracy.
void let_contradicting_share(EstimatedAnchors& estimated, std::size_t given, double max_stretch);

}  // namespace bespoke
