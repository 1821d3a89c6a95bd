#include "bespoke/rigid/as_similar_as_possible.h"

#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/rigid/nearest_rotation.h"

namespace bespoke {

AsSimilarAsPossible::AsSimilarAsPossible(GraphEdges edges)
    : similarities(edges.size(), Matrix3::Identity()), edges_(std::move(edges)) {}

void AsSimilarAsPossible::fit_similarities(const Points& places, double smoothness, int sweeps) {
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

void AsSimilarAsPossible::set_constraints(std::vector<SoftConstraint> constraints, double stiffness) {
  constraints_ = std::move(constraints);
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
  for (const SoftConstraint& constraint : constraints_)
    for (const auto& [a, share_of_a] : constraint.shares)
      for (const auto& [b, share_of_b] : constraint.shares)
        entries.emplace_back(a, b, constraint.weight * share_of_a * share_of_b);
  const auto size = static_cast<Eigen::Index>(edges_.size());
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  if (!std::exchange(analysed_, true)) factor_.analyzePattern(matrix);
  factor_.factorize(matrix);
  if (factor_.info() != Eigen::Success)
    throw SolverError("the as-similar-as-possible system of " + std::to_string(size) +
                      " nodes is not positive definite");
}

Points AsSimilarAsPossible::places(const Points& targets) const {
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(static_cast<Eigen::Index>(edges_.size()), 3);
  for (std::size_t node = 0; node < edges_.size(); ++node)
    for (const GraphEdge& edge : edges_[node]) {
      const Vector3 pull = stiffness_ * edge.weight * (similarities[node] * edge.rest);
      right.row(edge.to) += pull.transpose();
      right.row(static_cast<Eigen::Index>(node)) -= pull.transpose();
    }
  for (std::size_t k = 0; k < constraints_.size(); ++k)
    for (const auto& [node, share] : constraints_[k].shares)
      right.row(node) +=
          constraints_[k].weight * share * targets.col(static_cast<Eigen::Index>(k)).transpose();
  return factor_.solve(right).transpose();
}

}  // namespace bespoke
