#pragma once

#include <utility>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Pairs of faces (smaller index first, in increasing order) of which one passes through the other: an edge
/// of one meets the inside of the other and leaves on its other side. Faces that share a vertex, or have
/// vertices at one position, are no pair; faces that only touch, or overlap in one plane, are none either.
/// Signs that rounding could have turned count as touching. Parallel inside, same result at any thread count.
/// Throws InvalidInput for a mesh that is not valid.
std::vector<std::pair<int, int>> self_intersections(const TriangleMesh& mesh);

/// Of them those with one of the first `count` faces, without looking for the others.
std::vector<std::pair<int, int>> intersections_of_first(const TriangleMesh& mesh, Eigen::Index count);

/// Of them those with one of the flagged faces (a flag a face), without looking for the others.
std::vector<std::pair<int, int>> intersections_of(const TriangleMesh& mesh,
                                                  const std::vector<char>& is_looked_at);

/// Of pairs of faces, the smaller index first, those that are in self_intersections.
std::vector<std::pair<int, int>> intersecting(const TriangleMesh& mesh,
                                              std::vector<std::pair<int, int>> pairs);

}  // namespace bespoke
