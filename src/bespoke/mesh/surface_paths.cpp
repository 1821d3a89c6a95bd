#include "bespoke/mesh/surface_paths.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {
namespace {

/// A way that leads both ways.
struct Link {
  int a = 0, b = 0;
  double length = 0;
};

double distance_between(const TriangleMesh& mesh, int a, int b) {
  return (mesh.vertices.col(a) - mesh.vertices.col(b)).norm();
}

std::vector<Link> edge_links(const TriangleMesh& mesh, const MeshEdges& edges) {
  std::vector<Link> links;
  for (const MeshEdge& edge : edges.edges)
    links.push_back({edge.a, edge.b, distance_between(mesh, edge.a, edge.b)});
  return links;
}

/// Both faces along the edge unfolded into a plane: how far apart their other corners p and q are, if the
/// line between them crosses the edge.
std::optional<double> crossing_length(const TriangleMesh& mesh, const MeshEdge& edge, int p, int q) {
  const Vector3 origin = mesh.vertices.col(edge.a);
  const Vector3 along = mesh.vertices.col(edge.b) - origin;
  const double length = along.norm();
  if (!(length > 0)) return std::nullopt;
  const auto flattened = [&](int vertex) {
    const Vector3 arm = mesh.vertices.col(vertex) - origin;
    return Eigen::Vector2d(arm.dot(along) / length, arm.cross(along).norm() / length);
  };
  const Eigen::Vector2d left = flattened(p), right = flattened(q);
  const double apart = left.y() + right.y();
  if (!(apart > 0)) return std::nullopt;
  const double crossing = left.x() + (right.x() - left.x()) * left.y() / apart;
  if (!(crossing > 0 && crossing < length)) return std::nullopt;
  return std::hypot(right.x() - left.x(), apart);
}

void add_crossings(const TriangleMesh& mesh, const MeshEdges& edges, std::vector<Link>& links) {
  constexpr int none = -1;
  std::vector<std::array<int, 2>> opposite(edges.edges.size(), {none, none});
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (int k = 0; k < 3; ++k) {
      const int edge = edges.of_face(k, face);
      if (edge == MeshEdges::none) continue;
      std::array<int, 2>& corners = opposite[static_cast<std::size_t>(edge)];
      corners[corners[0] == none ? 0 : 1] = mesh.faces((k + 2) % 3, face);
    }
  for (std::size_t i = 0; i < opposite.size(); ++i) {
    const auto [p, q] = opposite[i];
    if (edges.edges[i].faces() != 2 || p == q) continue;
    if (const std::optional<double> length = crossing_length(mesh, edges.edges[i], p, q))
      links.push_back({p, q, *length});
  }
}

SurfaceGraph graph_of(std::size_t vertices, const std::vector<Link>& links) {
  SurfaceGraph graph;
  graph.start.assign(vertices + 1, 0);
  for (const Link& link : links)
    for (const int vertex : {link.a, link.b}) ++graph.start[static_cast<std::size_t>(vertex) + 1];
  for (std::size_t v = 0; v < vertices; ++v) graph.start[v + 1] += graph.start[v];
  graph.neighbours.resize(2 * links.size());
  graph.lengths.resize(2 * links.size());
  std::vector<int> next(graph.start.begin(), graph.start.end() - 1);
  const auto add = [&](int from, int to, double length) {
    const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(from)]++);
    graph.neighbours[at] = to;
    graph.lengths[at] = length;
  };
  for (const Link& link : links) {
    add(link.a, link.b, link.length);
    add(link.b, link.a, link.length);
  }
  return graph;
}

}  // namespace

SurfaceGraph edge_graph(const TriangleMesh& mesh) {
  return graph_of(static_cast<std::size_t>(mesh.vertices.cols()), edge_links(mesh, mesh_edges(mesh)));
}

SurfaceGraph edge_and_crossing_graph(const TriangleMesh& mesh) {
  const MeshEdges edges = mesh_edges(mesh);
  std::vector<Link> links = edge_links(mesh, edges);
  add_crossings(mesh, edges, links);
  return graph_of(static_cast<std::size_t>(mesh.vertices.cols()), links);
}

std::array<PathStart, 3> path_starts(const TriangleMesh& mesh, const SurfacePoint& point) {
  std::array<PathStart, 3> starts;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const int corner = mesh.faces(k, point.face);
    starts[static_cast<std::size_t>(k)] = {corner, (mesh.vertices.col(corner) - point.point).norm()};
  }
  return starts;
}

double length_to(const Eigen::VectorXd& lengths, std::span<const PathStart> point) {
  double length = std::numeric_limits<double>::infinity();
  for (const PathStart& corner : point) length = std::min(length, lengths[corner.vertex] + corner.distance);
  return length;
}

Eigen::VectorXd path_lengths(const SurfaceGraph& graph, std::span<const PathStart> starts) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Eigen::VectorXd lengths =
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(graph.start.size()) - 1, infinity);
  ShortestPaths(graph).visit_within(starts, infinity,
                                    [&](int vertex, double distance) { lengths[vertex] = distance; });
  return lengths;
}

}  // namespace bespoke
