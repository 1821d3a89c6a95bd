#include "bespoke/surface_fit/detail/displacement_smoother.h"

#include <cmath>
#include <string>

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/rbf/conjugate_gradients.h"

namespace bespoke {
namespace {

using Triplet = Eigen::Triplet<double>;
using Factor = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>;

/// I + L of Eq. 13.
Eigen::SparseMatrix<double> umbrella_system(const TriangleMesh& mesh,
                                            const std::vector<DisplacementAnchor>& anchors,
                                            double stiffness) {
  const VertexAdjacency adjacency = vertex_adjacency(mesh);
  const auto count = static_cast<int>(mesh.vertices.cols());
  std::vector<Triplet> entries;
  entries.reserve(adjacency.neighbours.size() + static_cast<std::size_t>(count) + 9 * anchors.size());
  for (int i = 0; i < count; ++i) {
    const auto row = static_cast<std::size_t>(i);
    const int valence = adjacency.start[row + 1] - adjacency.start[row];
    entries.emplace_back(i, i, 1 + stiffness * valence);
    for (int k = adjacency.start[row]; k < adjacency.start[row + 1]; ++k)
      entries.emplace_back(i, adjacency.neighbours[static_cast<std::size_t>(k)], -stiffness);
  }
  for (const DisplacementAnchor& anchor : anchors)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        entries.emplace_back(anchor.vertices[i], anchor.vertices[j],
                             anchor.weight * anchor.barycentric[i] * anchor.barycentric[j]);
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// I + L without the ones of the unmatched vertices. It differs from the factored matrix in a few diagonal
/// entries: conjugate gradients preconditioned by the factor need few steps, and no new factorisation.
struct UnmatchedSystem {
  static constexpr int max_steps = 50;
  static constexpr double relative_residual = 1e-5;  // of a displacement: far below what a step changes

  const Eigen::SparseMatrix<double>& matrix;
  const Factor& factor;
  const Eigen::VectorXd& missing;  // 1 for an unmatched vertex
  Vector3 enough = Vector3::Zero();

  Points multiply(const Points& x) const {
    return (matrix * x.transpose()).transpose() - x * missing.asDiagonal();
  }
  Points precondition(const Points& residual) const { return factor.solve(residual.transpose()).transpose(); }
  Vector3 products(const Points& a, const Points& b) const { return a.cwiseProduct(b).rowwise().sum(); }
  bool solved(const Points&, const Vector3& product, int steps) const {
    return steps == max_steps || (product.array() <= enough.array()).all();
  }
};

}  // namespace

DisplacementSmoother::DisplacementSmoother(const TriangleMesh& mesh,
                                           const std::vector<DisplacementAnchor>& anchors, double stiffness)
    : anchors_(anchors) {
  if (!(stiffness >= 0 && std::isfinite(stiffness)))
    throw InvalidInput("stiffness is " + std::to_string(stiffness) + ", but must be finite and at least 0");
  matrix_ = umbrella_system(mesh, anchors_, stiffness);
  factor_.compute(matrix_);
  if (factor_.info() != Eigen::Success)
    throw SolverError("the surface-fitting matrix of " + std::to_string(matrix_.rows()) +
                      " vertices could not be factored");
}

Points DisplacementSmoother::solve(const Points& wished, const std::vector<char>& matched,
                                   const Points& anchor_wished) const {
  Points right = wished;
  Eigen::VectorXd missing = Eigen::VectorXd::Zero(right.cols());
  for (Eigen::Index i = 0; i < right.cols(); ++i)
    if (!matched[static_cast<std::size_t>(i)]) {
      right.col(i).setZero();
      missing[i] = 1;
    }
  for (std::size_t k = 0; k < anchors_.size(); ++k)
    for (int corner = 0; corner < 3; ++corner)
      right.col(anchors_[k].vertices[corner]) += anchors_[k].weight * anchors_[k].barycentric[corner] *
                                                 anchor_wished.col(static_cast<Eigen::Index>(k));
  Points solution = factor_.solve(right.transpose()).transpose();
  if (!(missing.maxCoeff() > 0)) return solution;

  UnmatchedSystem system{matrix_, factor_, missing};
  system.enough = system.relative_residual * system.relative_residual * system.products(right, solution);
  conjugate_gradients(system, solution, right - system.multiply(solution));
  return solution;
}

}  // namespace bespoke
