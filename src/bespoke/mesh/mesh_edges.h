#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// An edge and the faces along it.
struct MeshEdge {
  int a = 0, b = 0;  ///< vertices, a < b
  int forward = 0;   ///< faces that run from a to b
  int backward = 0;  ///< faces that run from b to a

  int faces() const { return forward + backward; }
  bool on_boundary() const { return faces() == 1; }
};

/// Every edge once, and the edges of every face. A face that names a vertex twice has none.
struct MeshEdges {
  static constexpr int none = -1;

  std::vector<MeshEdge> edges;  ///< sorted by (a, b)
  Eigen::Matrix3Xi of_face;     ///< 3×m: row k is the edge from corner k to corner k + 1, an index or `none`

  /// Whether the edge from corner k to corner k + 1 belongs to no other face.
  bool on_boundary(Eigen::Index face, int k) const {
    const int edge = of_face(k, face);
    return edge != none && edges[static_cast<std::size_t>(edge)].on_boundary();
  }
};

/// In time linear in the faces. Indices must be within range.
MeshEdges mesh_edges(const TriangleMesh& mesh);

/// The vertices that share an edge with each vertex, in increasing order: neighbours of vertex v are
/// `neighbours[start[v]] … neighbours[start[v + 1] - 1]`.
struct VertexAdjacency {
  std::vector<int> start;  ///< n+1
  std::vector<int> neighbours;
};

VertexAdjacency vertex_adjacency(const TriangleMesh& mesh);

/// One flag per vertex: 1 where the vertex lies on an edge of exactly one face.
std::vector<char> boundary_vertices(const TriangleMesh& mesh);

/// 2×e: the vertices of the edges of exactly one face, along the face, in the order of the faces.
Eigen::Matrix2Xi boundary_edges(const TriangleMesh& mesh, const MeshEdges& edges);

}  // namespace bespoke
