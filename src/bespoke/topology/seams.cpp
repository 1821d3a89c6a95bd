#include "bespoke/topology/seams.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "bespoke/mesh/disjoint_sets.h"
#include "bespoke/mesh/equal_positions.h"
#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {

JoinedMesh joined_at_seams(const TriangleMesh& mesh) {
  const std::vector<int> place = first_at_equal_position(mesh.vertices);
  /// Where an open edge ends, and its vertices there.
  struct OpenEdge {
    std::pair<int, int> places, vertices;
  };
  std::vector<OpenEdge> open;
  for (const MeshEdge& edge : mesh_edges(mesh).edges) {
    const int a = place[static_cast<std::size_t>(edge.a)], b = place[static_cast<std::size_t>(edge.b)];
    if (!edge.on_boundary() || a == b) continue;
    open.push_back(a < b ? OpenEdge{{a, b}, {edge.a, edge.b}} : OpenEdge{{b, a}, {edge.b, edge.a}});
  }
  std::sort(open.begin(), open.end(),
            [](const OpenEdge& one, const OpenEdge& other) { return one.places < other.places; });
  DisjointSets sets(static_cast<int>(mesh.vertices.cols()));
  for (std::size_t i = 1; i < open.size(); ++i) {
    if (open[i].places != open[i - 1].places) continue;
    sets.join(open[i].vertices.first, open[i - 1].vertices.first);
    sets.join(open[i].vertices.second, open[i - 1].vertices.second);
  }
  JoinedMesh result{{{}, mesh.faces}, {}, {}};
  for (int vertex = 0; vertex < mesh.vertices.cols(); ++vertex) {
    const int least = sets.least(vertex);
    result.of_vertex.push_back(least < vertex ? result.of_vertex[static_cast<std::size_t>(least)]
                                              : static_cast<int>(result.first.size()));
    if (least == vertex) result.first.push_back(vertex);
  }
  result.mesh.vertices = mesh.vertices(Eigen::all, result.first);
  for (int& vertex : result.mesh.faces.reshaped())
    vertex = result.of_vertex[static_cast<std::size_t>(vertex)];
  return result;
}

JoinedMesh left_open(const TriangleMesh& mesh) {
  std::vector<int> same(static_cast<std::size_t>(mesh.vertices.cols()));
  std::iota(same.begin(), same.end(), 0);
  return {mesh, same, same};
}

}  // namespace bespoke
