#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A mesh whose long edges were halved, and where its new vertices came from.
struct RefinedMesh {
  TriangleMesh mesh;         ///< the vertices of the input first, in their order
  Eigen::Matrix2Xi parents;  ///< one column per new vertex: the two vertices it is the midpoint of
  std::vector<int> origins;  ///< one per face: the face of the input that it is a part of
};

/// Halves every edge longer than `max_length` (> 0, mesh units) at its midpoint, in up to `max_passes`
/// rounds, without hanging vertices. The surface stays the same set of points. Throws InvalidInput unless
/// max_length is positive.
RefinedMesh refine_long_edges(const TriangleMesh& mesh, double max_length, int max_passes = 6);

}  // namespace bespoke
