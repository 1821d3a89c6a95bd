#include "bespoke/rigid/similar_graph.h"

#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/rigid/nearest_rotation.h"

namespace bespoke {

SimilarGraph::SimilarGraph(GraphEdges edges)
    : similarities(edges.size(), Matrix3::Identity()), edges_(std::move(edges)) {}

void SimilarGraph::fit_similarities(const Points& places, double smoothness, int sweeps) {
  std::vector<Matrix3> covariances(edges_.size(), Matrix3::Zero());
  std::vector<double> spreads(edges_.size(), 0.0);
  for (std::size_t node = 0; node < edges_.size(); ++node)
    for (const GraphEdge& edge : edges_[node]) {
      const Vector3 now = places.col(edge.to) - places.col(static_cast<Eigen::Index>(node));
      covariances[node] += edge.weight * now * edge.rest.transpose();
      spreads[node] += edge.weight * edge.rest.squaredNorm();
    }
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t node = 0; node < edges_.size(); ++node) {
      Matrix3 wanted = covariances[node];
      if (smoothness > 0)
        for (const GraphEdge& edge : edges_[node])
          wanted += 2 * smoothness * similarities[static_cast<std::size_t>(edge.to)];
      const auto [rotation, trace] = nearest_rotation(wanted);
      // Each pair of neighbours counts from both ends; a rotation's squared norm is 3.
      const double of_neighbours = 6 * smoothness * static_cast<double>(edges_[node].size());
      similarities[node] = (trace / (spreads[node] + of_neighbours)) * rotation;
    }
}

void SimilarGraph::set_drawn(std::vector<DrawnPoint> points, double stiffness) {
  drawn_ = std::move(points);
  stiffness_ = stiffness;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t node = 0; node < edges_.size(); ++node)
    for (const auto& [other, rest, own_weight] : edges_[node]) {
      const int from = static_cast<int>(node);
      const double weight = stiffness * own_weight;
      entries.emplace_back(from, from, weight);
      entries.emplace_back(other, other, weight);
      entries.emplace_back(from, other, -weight);
      entries.emplace_back(other, from, -weight);
    }
  for (const DrawnPoint& point : drawn_)
    for (const auto& [a, share_of_a] : point.shares)
      for (const auto& [b, share_of_b] : point.shares)
        entries.emplace_back(a, b, point.weight * share_of_a * share_of_b);
  const auto size = static_cast<Eigen::Index>(edges_.size());
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  if (!std::exchange(analysed_, true)) factor_.analyzePattern(matrix);
  factor_.factorize(matrix);
  if (factor_.info() != Eigen::Success)
    throw SolverError("the system of " + std::to_string(size) +
                      " nodes that follow drawn points is not positive definite");
}

Points SimilarGraph::places(const Points& goals) const {
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(static_cast<Eigen::Index>(edges_.size()), 3);
  for (std::size_t node = 0; node < edges_.size(); ++node)
    for (const GraphEdge& edge : edges_[node]) {
      const Vector3 pull = stiffness_ * edge.weight * (similarities[node] * edge.rest);
      right.row(edge.to) += pull.transpose();
      right.row(static_cast<Eigen::Index>(node)) -= pull.transpose();
    }
  for (std::size_t k = 0; k < drawn_.size(); ++k)
    for (const auto& [node, share] : drawn_[k].shares)
      right.row(node) += drawn_[k].weight * share * goals.col(static_cast<Eigen::Index>(k)).transpose();
  return factor_.solve(right).transpose();
}

}  // namespace bespoke
