#pragma once

#include <array>
#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Ways between the vertices of a mesh: those of vertex v lead to `neighbours[start[v]] … neighbours[start[v
/// + 1] - 1]`.
struct SurfaceGraph {
  std::vector<int> start;  ///< n+1
  std::vector<int> neighbours;
  std::vector<double> lengths;  ///< one per neighbour, mesh units
};

/// Along the edges.
SurfaceGraph edge_graph(const TriangleMesh& mesh);

/// Along the edges, and straight across two faces that share an edge with no other one, between the corners
/// opposite to it, where that line crosses the edge. Paths over a square grid are longer than on the plane by
/// at most 1 / cos 22.5° − 1 = 8.2 %, since they go eight ways; over its edges alone by up to 41 %.
SurfaceGraph edge_and_crossing_graph(const TriangleMesh& mesh);

/// Where paths begin.
struct PathStart {
  int vertex = 0;
  double distance = 0;  ///< ≥ 0, mesh units: the way up to there
};

/// Shortest paths through a graph, which must outlive this (Dijkstra). The arrays are reused from call to
/// call; one object per thread.
class ShortestPaths {
 public:
  explicit ShortestPaths(const SurfaceGraph& graph)
      : graph_(graph), distance_(graph.start.size() - 1, infinity) {}

  /// Calls visit(vertex, distance) for the vertices nearer than `limit` (mesh units), the nearest first;
  /// equally near ones by their numbers.
  template <class Visit>
  void visit_within(std::span<const PathStart> starts, double limit, const Visit& visit) {
    for (const int vertex : touched_) distance_[static_cast<std::size_t>(vertex)] = infinity;
    touched_.clear();
    for (const PathStart& start : starts) reach(start.vertex, start.distance, limit);
    while (!queue_.empty()) {
      const auto [distance, vertex] = queue_.top();
      queue_.pop();
      const auto v = static_cast<std::size_t>(vertex);
      if (distance > distance_[v]) continue;
      visit(vertex, distance);
      for (auto k = static_cast<std::size_t>(graph_.start[v]);
           k < static_cast<std::size_t>(graph_.start[v + 1]); ++k)
        reach(graph_.neighbours[k], distance + graph_.lengths[k], limit);
    }
  }

 private:
  using Near = std::pair<double, int>;  // distance, vertex: sorts by distance, then by number
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  void reach(int vertex, double distance, double limit) {
    double& known = distance_[static_cast<std::size_t>(vertex)];
    if (!(distance < limit && distance < known)) return;
    if (known == infinity) touched_.push_back(vertex);
    known = distance;
    queue_.emplace(distance, vertex);
  }

  const SurfaceGraph& graph_;
  std::vector<double> distance_;
  std::vector<int> touched_;
  std::priority_queue<Near, std::vector<Near>, std::greater<>> queue_;
};

/// Paths from a point of a face begin at its corners: two points of one face are farther apart by them.
std::array<PathStart, 3> path_starts(const TriangleMesh& mesh, const SurfacePoint& point);

/// Of the paths whose `lengths` (n) to all vertices are known, on to a point that starts there.
double length_to(const Eigen::VectorXd& lengths, std::span<const PathStart> point);

/// n: the lengths of the shortest paths to all vertices, mesh units; infinite where none leads.
Eigen::VectorXd path_lengths(const SurfaceGraph& graph, std::span<const PathStart> starts);

}  // namespace bespoke
