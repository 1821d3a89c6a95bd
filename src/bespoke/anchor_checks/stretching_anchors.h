#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/anchors/anchor_accuracy.h"
#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// What contradicting exact pairs have to give way by: of two that are farther apart on one model than paths
/// along the other, as large as this one, lead by more than the factor `max_stretch` (> 1), each half of the
/// difference, as σ, mesh units on the target. No surface map then meets both within that stretch: a path
/// becomes a path, which is no shorter than the straight line. Two hands that are folded on one model only
/// contradict nothing. Paths go along edges and across faces (edge_and_crossing_graph), less two edges, which
/// is what they tell; differences below 0.1 % of the targets' diagonal in every coordinate are remeshing. One
/// a pair, 0 for pairs that contradict none, and for those that are not exact, or that contradict half of the
/// others: these are astray, and nobody shares their blame. Of the first `count` pairs.
std::vector<double> sigmas_within_stretch(const Anchors& anchors, std::size_t count,
                                          const TriangleMesh& source, const TriangleMesh& target,
                                          double max_stretch);

/// Gives such pairs of the first `given` these σ, and names them in the accuracy.
void let_contradicting_share(EstimatedAnchors& estimated, std::size_t given, const TriangleMesh& source,
                             const TriangleMesh& target, double max_stretch);

}  // namespace bespoke
