#pragma once

#include <vector>

#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {

/// Harmonic extension (discrete Laplace equation): the displacements (3×n) with those of the free vertices
/// replaced by the mean of their neighbours', weighted by inverse length at `places` (3×n), so that
/// displacements change as fast across short edges as across long ones. A component that is wholly free
/// moves by the weighted mean of its own displacements. Throws SolverError.
Points extend_harmonically(const Points& places, const VertexAdjacency& adjacency,
                           const std::vector<int>& free, Points displacements);

}  // namespace bespoke
