#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// The parts of a mesh that share no vertex: its connected components, in the order of their least vertices.
struct MeshComponents {
  static constexpr int none = -1;

  std::vector<int> of_vertex;  ///< n: a component's number, or `none` for a vertex in no face
  std::vector<int> of_face;    ///< m
  std::vector<int> vertices;   ///< of each component, how many
  std::vector<int> faces;      ///< of each component, how many

  int count() const { return static_cast<int>(faces.size()); }
};

/// Indices must be within range. Vertices at one place are not joined: see joined_at_seams (seams.h).
MeshComponents mesh_components(const TriangleMesh& mesh);

/// Some faces of a mesh, with the vertices that they use.
struct PartialMesh {
  TriangleMesh mesh;
  std::vector<int> vertices;  ///< for every vertex of `mesh` its number in the whole; ascending
};

/// The components that are marked in `is_kept` (one flag a component).
PartialMesh kept_components(const TriangleMesh& mesh, const MeshComponents& components,
                            const std::vector<char>& is_kept);

}  // namespace bespoke
