#include "bespoke/mesh/mesh_edges.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace bespoke {
namespace {

bool has_three_vertices(const Faces& faces, Eigen::Index face) {
  return faces(0, face) != faces(1, face) && faces(1, face) != faces(2, face) &&
         faces(2, face) != faces(0, face);
}

/// Calls visit(from, to, face, k) for the sides of the faces that have edges.
template <class Visit>
void for_each_side(const Faces& faces, const Visit& visit) {
  for (Eigen::Index face = 0; face < faces.cols(); ++face) {
    if (!has_three_vertices(faces, face)) continue;
    for (int k = 0; k < 3; ++k) visit(faces(k, face), faces((k + 1) % 3, face), face, k);
  }
}

/// A side of a face, seen from the smaller of its vertices.
struct Side {
  int larger;
  bool forward;
  int index;  ///< 3 · face + k
};

/// The sides by their smaller vertex v: sides[start[v]] … sides[start[v + 1] - 1], each list sorted.
struct SidesOfVertices {
  std::vector<std::size_t> start;
  std::vector<Side> sides;
};

SidesOfVertices sides_of_vertices(const TriangleMesh& mesh) {
  SidesOfVertices result;
  result.start.assign(static_cast<std::size_t>(mesh.vertices.cols()) + 1, 0);
  for_each_side(mesh.faces, [&](int from, int to, Eigen::Index, int) {
    ++result.start[static_cast<std::size_t>(std::min(from, to)) + 1];
  });
  std::partial_sum(result.start.begin(), result.start.end(), result.start.begin());
  result.sides.resize(result.start.back());
  std::vector<std::size_t> next(result.start.begin(), result.start.end() - 1);
  for_each_side(mesh.faces, [&](int from, int to, Eigen::Index face, int k) {
    result.sides[next[static_cast<std::size_t>(std::min(from, to))]++] = {std::max(from, to), from < to,
                                                                          static_cast<int>(3 * face + k)};
  });
  for (std::size_t vertex = 0; vertex + 1 < result.start.size(); ++vertex)
    std::sort(result.sides.begin() + static_cast<std::ptrdiff_t>(result.start[vertex]),
              result.sides.begin() + static_cast<std::ptrdiff_t>(result.start[vertex + 1]),
              [](const Side& x, const Side& y) { return x.larger < y.larger; });
  return result;
}

}  // namespace

MeshEdges mesh_edges(const TriangleMesh& mesh) {
  const SidesOfVertices by_vertex = sides_of_vertices(mesh);
  MeshEdges result;
  result.edges.reserve(by_vertex.sides.size() / 2);
  result.of_face.setConstant(3, mesh.faces.cols(), MeshEdges::none);
  for (std::size_t vertex = 0; vertex + 1 < by_vertex.start.size(); ++vertex) {
    const std::size_t begin = by_vertex.start[vertex];
    for (std::size_t k = begin; k < by_vertex.start[vertex + 1]; ++k) {
      const Side& side = by_vertex.sides[k];
      if (k == begin || side.larger != result.edges.back().b)
        result.edges.push_back({static_cast<int>(vertex), side.larger, 0, 0});
      ++(side.forward ? result.edges.back().forward : result.edges.back().backward);
      result.of_face(side.index % 3, side.index / 3) = static_cast<int>(result.edges.size()) - 1;
    }
  }
  return result;
}

VertexAdjacency vertex_adjacency(const TriangleMesh& mesh) {
  const std::vector<MeshEdge> edges = mesh_edges(mesh).edges;
  VertexAdjacency adjacency;
  adjacency.start.assign(static_cast<std::size_t>(mesh.vertices.cols()) + 1, 0);
  for (const MeshEdge& edge : edges) {
    ++adjacency.start[static_cast<std::size_t>(edge.a) + 1];
    ++adjacency.start[static_cast<std::size_t>(edge.b) + 1];
  }
  std::partial_sum(adjacency.start.begin(), adjacency.start.end(), adjacency.start.begin());
  adjacency.neighbours.resize(2 * edges.size());
  std::vector<int> next(adjacency.start.begin(), adjacency.start.end() - 1);
  const auto add = [&](int vertex, int neighbour) {
    adjacency.neighbours[static_cast<std::size_t>(next[static_cast<std::size_t>(vertex)]++)] = neighbour;
  };
  // Edges come sorted, so smaller neighbours first, then larger ones, fills every list in order.
  for (const MeshEdge& edge : edges) add(edge.b, edge.a);
  for (const MeshEdge& edge : edges) add(edge.a, edge.b);
  return adjacency;
}

std::vector<char> boundary_vertices(const TriangleMesh& mesh) {
  std::vector<char> on_boundary(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for (const MeshEdge& edge : mesh_edges(mesh).edges) {
    if (!edge.on_boundary()) continue;
    on_boundary[static_cast<std::size_t>(edge.a)] = 1;
    on_boundary[static_cast<std::size_t>(edge.b)] = 1;
  }
  return on_boundary;
}

Eigen::Matrix2Xi boundary_edges(const TriangleMesh& mesh, const MeshEdges& edges) {
  std::vector<Eigen::Vector2i> found;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (int k = 0; k < 3; ++k)
      if (edges.on_boundary(face, k)) found.emplace_back(mesh.faces(k, face), mesh.faces((k + 1) % 3, face));
  Eigen::Matrix2Xi result(2, static_cast<Eigen::Index>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = found[i];
  return result;
}

}  // namespace bespoke
