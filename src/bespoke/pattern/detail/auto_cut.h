#pragma once

#include <array>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Edges (vertex, vertex) along which a connected, oriented manifold becomes a disk: of all graphs that are
/// made of shortest paths from the first boundary loop (of a closed surface, from a vertex), the one of the
/// shortest loops (tree and cotree, Erickson and Whittlesey 2005). A closed surface without handles is opened
/// along a way between two vertices far apart. Empty for a disk.
std::vector<std::array<int, 2>> edges_to_a_disk(const TriangleMesh& mesh);

}  // namespace bespoke
