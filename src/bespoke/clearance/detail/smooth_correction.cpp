#include "bespoke/clearance/detail/smooth_correction.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bespoke/error.h"

namespace bespoke {
namespace {

// ρ²: with ℓ a quarter of the reach, what an end of the reach feels is e⁻⁴. On a regular mesh the umbrella
// operator is -¼ of the Laplacian, in edges.
constexpr double length_in_edges = reach_in_edges / 4.0;
constexpr double smoothness = 4 * length_in_edges * length_in_edges;

/// H⁻¹ b by the factor, three columns at a time: Eigen would go through it once a column.
NodeVectors solved(const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>& factor, const NodeVectors& b) {
  using Lower = Eigen::SparseMatrix<double>;
  const Lower& lower = factor.matrixL().nestedExpression();
  NodeVectors x = factor.permutationP() * b;
  for (Eigen::Index j = 0; j < x.rows(); ++j) {
    const Eigen::RowVector3d at = x.row(j);
    for (Lower::InnerIterator it(lower, j); it; ++it)
      if (it.row() > j) x.row(it.row()) -= it.value() * at;
  }
  const auto& diagonal = factor.vectorD();
  for (Eigen::Index j = x.rows() - 1; j >= 0; --j) {
    Eigen::RowVector3d at = x.row(j) / diagonal[j];
    for (Lower::InnerIterator it(lower, j); it; ++it)
      if (it.row() > j) at -= it.value() * x.row(it.row());
    x.row(j) = at;
  }
  return factor.permutationPinv() * x;
}

}  // namespace

SmoothCorrection::SmoothCorrection(const CorrectionGraph& graph) {
  const Eigen::Index nodes = graph.nodes();
  degree_ = (graph.weights * Eigen::VectorXd::Ones(nodes)).cwiseMax(1);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(graph.weights.nonZeros() + nodes));
  for (Eigen::Index i = 0; i < nodes; ++i) {
    double sum = 0;
    for (Eigen::SparseMatrix<double>::InnerIterator it(graph.weights, i); it; ++it) {
      entries.emplace_back(it.row(), i, -smoothness * it.value());
      sum += it.value();
    }
    entries.emplace_back(i, i, degree_[i] + smoothness * sum);
  }
  Eigen::SparseMatrix<double> matrix(nodes, nodes);
  matrix.setFromTriplets(entries.begin(), entries.end());
  factor_ = std::make_unique<const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>(matrix);
  if (factor_->info() != Eigen::Success)
    throw SolverError("the product's smoothness could not be factored (" + std::to_string(nodes) + " nodes)");
}

NodeVectors SmoothCorrection::operator()(const NodeVectors& forces) const {
  return solved(*factor_, degree_.asDiagonal() * solved(*factor_, forces));
}

Eigen::VectorXd SmoothCorrection::operator()(const Eigen::VectorXd& forces) const {
  return factor_->solve(degree_.cwiseProduct(factor_->solve(forces)));
}

NodeVectors minimised_energy(const SmoothCorrection& energy, const LinearConstraints& constraints,
                             double tolerance, int iterations, Eigen::VectorXd& multipliers) {
  const auto& [places, gradients, amounts] = constraints;
  const Eigen::SparseMatrix<double, Eigen::RowMajor> to_nodes = places.transpose();
  const auto displacement = [&](const Eigen::VectorXd& at) {
    return energy(NodeVectors(to_nodes * (gradients.array().colwise() * at.array()).matrix()));
  };
  const Eigen::VectorXd lengths = gradients.rowwise().norm();
  // H has no positive entry off its diagonal, so that its inverse has no negative one.
  const Eigen::SparseMatrix<double, Eigen::RowMajor> amounts_of_places = places.cwiseAbs();
  Eigen::VectorXd row_sums =
      (amounts_of_places * energy(Eigen::VectorXd(amounts_of_places.transpose() * lengths)))
          .cwiseProduct(lengths);
  // What moves no node, as a node against itself, keeps a multiplier of 0.
  row_sums = (row_sums.array() > 0).select(row_sums, std::numeric_limits<double>::infinity());
  multipliers = multipliers.cwiseMax(0);
  Eigen::VectorXd ahead = multipliers;
  double momentum = 1;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const NodeVectors u = displacement(ahead);
    const Eigen::VectorXd missing = amounts - (places * u).cwiseProduct(gradients).rowwise().sum();
    const Eigen::VectorXd next = (ahead + missing.cwiseQuotient(row_sums)).cwiseMax(0);
    const Eigen::VectorXd change = next - multipliers;
    if (missing.maxCoeff() <= tolerance && change.isZero(0)) break;
    const bool turned = missing.dot(change) < 0;
    const double following = turned ? 1 : (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
    ahead = next + (turned ? 0 : (momentum - 1) / following) * change;
    ahead = ahead.cwiseMax(0);
    momentum = following;
    multipliers = next;
    if (missing.maxCoeff() <= tolerance) break;
  }
  return displacement(multipliers);
}

}  // namespace bespoke
