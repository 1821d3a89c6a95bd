#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A mesh without its seams: edges that are cut open although both sides lie at the same places, as formats
/// with one normal and texture coordinate a vertex (glTF) leave them between charts, and soups everywhere.
struct JoinedMesh {
  TriangleMesh mesh;           ///< the same faces; of the vertices that a seam parts, the first
  std::vector<int> of_vertex;  ///< for every vertex its number in `mesh`
  std::vector<int> first;      ///< for every vertex of `mesh` the least number that it had

  std::size_t joined() const { return of_vertex.size() - first.size(); }  ///< vertices that are left out
};

/// Vertices at one place are joined where edges of one face each end at them that have both ends in common.
/// What merely touches stays apart. Throws InvalidInput for coordinates that are not finite.
JoinedMesh joined_at_seams(const TriangleMesh& mesh);

/// The mesh as it is, nothing joined.
JoinedMesh left_open(const TriangleMesh& mesh);

}  // namespace bespoke
