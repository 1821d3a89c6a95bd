#pragma once

#include <vector>

#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// One per vertex: whether it sees next to nothing of the open, wherever it looks out of the surface: the
/// cavities of mouths, sockets and nostrils, pockets; small ones of fine meshes are missed. A surface of
/// which that would be more than half (inside out, or lined throughout) is taken for one that lies in the
/// open.
std::vector<char> enclosed_vertices(const TriangleMesh& mesh);

/// A connected part of what is enclosed of a surface (enclosed_vertices), wider than its mouth, as of
/// a mouth, of a socket. Creases between parts that touch are none.
struct Cavity {
  std::vector<int> vertices;
  std::vector<MeshEdge> edges;  ///< at these vertices
};

struct Cavities {
  std::vector<char> contains;  ///< n: whether a vertex is in one
  std::vector<Cavity> parts;
};

Cavities cavities_of(const TriangleMesh& mesh);

}  // namespace bespoke
