#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Where a map stretches or squeezes the source's surface too much.
struct StretchedEdges {
  std::size_t count = 0;
  double max_factor = 1;        ///< of a length, beside the median of all edges
  std::vector<Vector3> places;  ///< on the source, the worst first: at most three, apart from each other
};

/// Edges that grow or shrink by more than `max_stretch` (> 1) beside the median of all, by more than
/// remeshing explains: 0.1 % of the images' diagonal. images: 3×n, where the map takes the source's vertices.
/// Edges without length are none.
StretchedEdges stretched_edges(const TriangleMesh& source, const Points& images, double max_stretch);

/// One line, empty without any: how many, by how much, and where.
std::string to_string(const StretchedEdges& stretched);

}  // namespace bespoke
