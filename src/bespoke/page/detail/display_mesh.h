#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A mesh as it is drawn: some of its vertices, where they are, and triangles between them.
struct DisplayMesh {
  std::vector<int> original;  ///< by vertex shown, its index in the mesh; increasing
  Faces faces;                ///< indices into `original`
  bool is_whole = true;       ///< everything is shown

  /// The columns of what is known for each vertex of the mesh, for those that are shown.
  Points shown(const Points& of_all) const;
};

/// At most `max_faces` triangles (> 0), or points where the mesh has no faces. A larger mesh is decimated
/// (see topology/decimation.h). Points, and soups whose triangles share too few edges for that, are thinned
/// by a grid of cubes: of the vertices in a cube the one nearest to their mean stays, and triangles whose
/// corners share a cube go. Throws InvalidInput for indices out of range.
DisplayMesh display_mesh(const TriangleMesh& mesh, std::size_t max_faces);

}  // namespace bespoke
