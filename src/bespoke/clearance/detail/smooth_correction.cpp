#include "bespoke/clearance/detail/smooth_correction.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "bespoke/error.h"
#include "bespoke/instruction_set.h"

namespace bespoke {
namespace {

// ρ²: with ℓ a quarter of the reach, what an end of the reach feels is e⁻⁴. On a regular mesh the umbrella
// operator is -¼ of the Laplacian, in edges.
constexpr double length_in_edges = reach_in_edges / 4.0;
constexpr double smoothness = 4 * length_in_edges * length_in_edges;

using Lower = Eigen::SparseMatrix<double>;

// Three numbers and one that fills a vector of the processor.
using Row = double __attribute__((vector_size(4 * sizeof(double))));

[[gnu::always_inline]] inline void load(const double* x, Row& row) { std::memcpy(&row, x, sizeof row); }
[[gnu::always_inline]] inline void store(const Row& row, double* x) { std::memcpy(x, &row, sizeof row); }

/// x becomes the solution of L D Lᵀ x = x, all its columns at a time: Eigen would go through L once a column.
/// `needed`: rows beyond which it is not finished.
struct Substitution {
  [[gnu::always_inline]] static void run(const Lower& lower, const Eigen::VectorXd& diagonal,
                                         const std::vector<char>& needed, double* x) {
    const int* start = lower.outerIndexPtr();
    const int* row = lower.innerIndexPtr();
    const double* value = lower.valuePtr();
    for (Eigen::Index j = 0; j < lower.cols(); ++j) {
      Row at, below;
      load(x + 4 * j, at);
      // Forces are at few nodes.
      if (at[0] == 0 && at[1] == 0 && at[2] == 0) continue;
      for (int i = start[j]; i < start[j + 1]; ++i) {
        if (row[i] <= j) continue;
        load(x + 4 * row[i], below);
        below -= value[i] * at;
        store(below, x + 4 * row[i]);
      }
    }
    for (Eigen::Index j = lower.cols() - 1; j >= 0; --j) {
      if (!needed[static_cast<std::size_t>(j)]) continue;
      Row at, below;
      load(x + 4 * j, at);
      at /= diagonal[j];
      for (int i = start[j]; i < start[j + 1]; ++i) {
        if (row[i] <= j) continue;
        load(x + 4 * row[i], below);
        at -= value[i] * below;
      }
      store(at, x + 4 * j);
    }
  }
};

/// H⁻¹ b by the factor.
NodeVectors solved(const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>& factor,
                   const std::vector<char>& needed, const NodeVectors& b) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
  Rows x = Rows::Zero(b.rows(), 4);
  const auto& place = factor.permutationP().indices();
  for (Eigen::Index i = 0; i < b.rows(); ++i) x.row(place[i]).head<3>() = b.row(i);
  run_dispatched<Substitution>(factor.matrixL().nestedExpression(), factor.vectorD(), needed, x.data());
  NodeVectors back(b.rows(), 3);
  for (Eigen::Index i = 0; i < b.rows(); ++i) back.row(i) = x.row(place[i]).head<3>();
  return back;
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

NodeVectors SmoothCorrection::operator()(const NodeVectors& forces, const SomeNodes& nodes) const {
  return solved(*factor_, nodes, degree_.asDiagonal() * solved(*factor_, all_nodes(), forces));
}

SmoothCorrection::SomeNodes SmoothCorrection::all_nodes() const {
  return SomeNodes(static_cast<std::size_t>(degree_.size()), 1);
}

/// What a row of the solution needs are the rows of its column of the factor, and so on: its ancestors in the
/// elimination tree.
SmoothCorrection::SomeNodes SmoothCorrection::nodes_of(
    const Eigen::SparseMatrix<double, Eigen::RowMajor>& places) const {
  const Lower& lower = factor_->matrixL().nestedExpression();
  SomeNodes needed(static_cast<std::size_t>(degree_.size()), 0);
  for (Eigen::Index i = 0; i < places.rows(); ++i)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(places, i); it; ++it)
      needed[static_cast<std::size_t>(factor_->permutationP().indices()[it.col()])] = 1;
  for (Eigen::Index j = 0; j < lower.cols(); ++j)
    if (needed[static_cast<std::size_t>(j)])
      for (Lower::InnerIterator it(lower, j); it; ++it) needed[static_cast<std::size_t>(it.row())] = 1;
  return needed;
}

Eigen::VectorXd SmoothCorrection::operator()(const Eigen::VectorXd& forces) const {
  return factor_->solve(degree_.cwiseProduct(factor_->solve(forces)));
}

NodeVectors minimised_energy(const SmoothCorrection& energy, const LinearConstraints& constraints,
                             double tolerance, int iterations, Eigen::VectorXd& multipliers) {
  const auto& [places, gradients, amounts] = constraints;
  const Eigen::SparseMatrix<double, Eigen::RowMajor> to_nodes = places.transpose();
  const auto displacement = [&](const Eigen::VectorXd& at, const SmoothCorrection::SomeNodes& nodes) {
    return energy(NodeVectors(to_nodes * (gradients.array().colwise() * at.array()).matrix()), nodes);
  };
  const SmoothCorrection::SomeNodes constrained = energy.nodes_of(places);
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
    const NodeVectors u = displacement(ahead, constrained);
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
  return displacement(multipliers, energy.all_nodes());
}

}  // namespace bespoke
