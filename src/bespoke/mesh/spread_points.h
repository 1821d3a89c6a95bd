#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Columns of at most `count` of the points (3×n), each the farthest from those before it, beginning with the
/// first; of points at one place one.
std::vector<int> spread_points(const Points& points, std::size_t count);

/// The same of the vertices in faces that have an area.
std::vector<int> spread_vertices(const TriangleMesh& mesh, std::size_t count);

}  // namespace bespoke
