#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A mesh of fewer triangles, with some of the vertices at their places.
struct DecimatedMesh {
  TriangleMesh mesh;
  std::vector<int> vertices;  ///< for every vertex of `mesh` its number in the whole; ascending
};

/// At most `max_faces` triangles, by meshoptimizer: edges collapse in the order of their quadric error
/// (Garland & Heckbert 1997); then edges of flat places flip until the triangles are Delaunay's. Vertices
/// that coincide along a seam become one; a vertex where the surface is no manifold stays. Faces that name a
/// vertex twice and vertices in no face are left out. Nothing goes that moves the surface by 5 % of the
/// mesh's extent: more than `max_faces` may remain. Indices must be within range.
DecimatedMesh decimated(const TriangleMesh& mesh, std::size_t max_faces);

}  // namespace bespoke
