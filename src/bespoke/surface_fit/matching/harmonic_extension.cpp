#include "bespoke/surface_fit/matching/harmonic_extension.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <string>

#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr double shortest = 1e-6;  // diagonals: shorter edges weigh no more
constexpr double kept = 1e-9;      // of a vertex's own weight: determines a component that is wholly free

}  // namespace

Points extend_harmonically(const Points& places, const VertexAdjacency& adjacency,
                           const std::vector<int>& free, Points displacements) {
  constexpr int fixed = -1;
  const double min_length = shortest * diagonal(places);
  std::vector<int> row_of(static_cast<std::size_t>(displacements.cols()), fixed);
  for (std::size_t k = 0; k < free.size(); ++k) row_of[free[k]] = static_cast<int>(k);
  const auto count = static_cast<int>(free.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(count, 3);
  for (int row = 0; row < count; ++row) {
    const int vertex = free[row];
    double total = 0;
    for (int k = adjacency.start[vertex]; k < adjacency.start[vertex + 1]; ++k) {
      const int other = adjacency.neighbours[k];
      const double length = (places.col(other) - places.col(vertex)).norm();
      const double weight = min_length / std::max(length, min_length);
      total += weight;
      if (row_of[other] == fixed)
        right.row(row) += weight * displacements.col(other).transpose();
      else
        entries.emplace_back(row, row_of[other], -weight);
    }
    const double keep = kept * total;
    right.row(row) += keep * displacements.col(vertex).transpose();
    entries.emplace_back(row, row, total + keep);
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
  if (factor.info() != Eigen::Success)
    throw SolverError("harmonic extension: the matrix of " + std::to_string(count) +
                      " free vertices is not positive definite");
  const Eigen::MatrixX3d solution = factor.solve(right);
  for (int row = 0; row < count; ++row) displacements.col(free[row]) = solution.row(row).transpose();
  return displacements;
}

}  // namespace bespoke
