#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Decimation ends as soon as one of the two is met.
struct DecimationOptions {
  std::size_t max_vertices = 0;
  std::size_t max_faces = 0;
};

/// A mesh of fewer triangles, with some of the vertices at their places.
struct DecimatedMesh {
  TriangleMesh mesh;
  std::vector<int> vertices;  ///< for every vertex of `mesh` its number in the whole; ascending
};

/// Collapses edges in the order of their quadric error (Garland & Heckbert 1997, with their planes through
/// the boundary), by OpenMesh. Vertices that coincide along a seam become one; a vertex where the surface is
/// no manifold stays. Faces that name a vertex twice and vertices in no face are left out. More than
/// requested remains of a mesh that has no edges to collapse. Indices must be within range.
DecimatedMesh decimated(const TriangleMesh& mesh, const DecimationOptions& options);

}  // namespace bespoke
