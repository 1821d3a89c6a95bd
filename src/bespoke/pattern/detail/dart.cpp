#include "bespoke/pattern/detail/dart.h"

#include <algorithm>
#include <cmath>

#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/mesh/surface_paths.h"

namespace bespoke {
namespace {

// Of the way from the outline to the middle. A dart that reaches the middle would leave no cloth for the next
// one.
constexpr double dart_depth = 0.85;

// Rounds in which a vertex takes the mean of its neighbours: single faces do not decide.
constexpr int smoothing_rounds = 5;

Eigen::VectorXd smoothed_at_vertices(const Piece& piece, const Eigen::VectorXd& strain) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(piece.mesh.vertices.cols()), count = sum;
  for (Eigen::Index f = 0; f < piece.mesh.faces.cols(); ++f)
    for (const int v : piece.mesh.faces.col(f)) {
      sum[v] += strain[f];
      count[v] += 1;
    }
  Eigen::VectorXd value = sum.cwiseQuotient(count);
  const VertexAdjacency adjacency = vertex_adjacency(piece.mesh);
  for (int round = 0; round < smoothing_rounds; ++round) {
    Eigen::VectorXd next = value;
    for (Eigen::Index v = 0; v < value.size(); ++v) {
      const int begin = adjacency.start[static_cast<std::size_t>(v)],
                end = adjacency.start[static_cast<std::size_t>(v) + 1];
      for (int k = begin; k < end; ++k) next[v] += value[adjacency.neighbours[static_cast<std::size_t>(k)]];
      next[v] /= end - begin + 1;
    }
    value = std::move(next);
  }
  return value;
}

}  // namespace

std::vector<int> dart_path(const Piece& piece, const Eigen::VectorXd& strain) {
  const SurfaceGraph graph = edge_graph(piece.mesh);
  std::vector<PathStart> outline;
  for (const int v : piece.outline) outline.push_back({v, 0});
  Eigen::Index middle = 0;
  if (!(path_lengths(graph, outline).maxCoeff(&middle) > 0)) return {};
  const Eigen::VectorXd value = smoothed_at_vertices(piece, strain);
  const int from = *std::max_element(piece.outline.begin(), piece.outline.end(),
                                     [&](int a, int b) { return value[a] < value[b]; });
  const PathStart start{static_cast<int>(middle), 0};
  const Eigen::VectorXd to_middle = path_lengths(graph, {&start, 1});
  std::vector<int> path{from};
  while (to_middle[path.back()] > (1 - dart_depth) * to_middle[from]) {
    const int at = path.back();
    int next = at;
    for (int k = graph.start[static_cast<std::size_t>(at)]; k < graph.start[static_cast<std::size_t>(at) + 1];
         ++k) {
      const int other = graph.neighbours[static_cast<std::size_t>(k)];
      if (to_middle[other] + graph.lengths[static_cast<std::size_t>(k)] <= to_middle[at] * (1 + 1e-12) &&
          (next == at || to_middle[other] < to_middle[next]))
        next = other;
    }
    if (next == at) break;
    path.push_back(next);
  }
  return path.size() < 2 ? std::vector<int>{} : path;
}

}  // namespace bespoke
