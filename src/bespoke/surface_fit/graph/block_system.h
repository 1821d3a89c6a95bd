#pragma once

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// Sparse symmetric positive definite system of 3×3 blocks with one fixed pattern: the symbolic factorisation
/// is done once, the numbers change. Not thread-safe.
class BlockSystem {
 public:
  /// adjacency[i]: the columns that row i may hold, in any order, repeats allowed; made symmetric by the
  /// caller. The diagonal is always there.
  explicit BlockSystem(std::vector<std::vector<int>> adjacency);

  int size() const { return static_cast<int>(start_.size()) - 1; }

  void set_zero();

  /// Adds `block` at (row, column) if it lies in the lower triangle (row ≥ column); else does nothing, since
  /// the caller adds the transposed entry as well.
  void add(int row, int column, const Matrix3& block) {
    if (row >= column) at(row, column) += block;
  }
  void add_right_side(int row, const Vector3& value) { right_side_.segment<3>(3 * row) += value; }

  /// 3×n: 2 (matrix x − right side), the gradient of the quadratic form that the system minimises, at x
  /// (3×n).
  Points gradient(const Points& x) const;

  /// 3×n. Throws SolverError when the matrix is not positive definite.
  Points solve();

 private:
  Matrix3& at(int row, int column);

  std::vector<int> start_;  // of each block column, in rows_ and blocks_
  std::vector<int> rows_;   // increasing in a column, the diagonal first
  std::vector<Matrix3> blocks_;
  Eigen::VectorXd right_side_;
  Eigen::SparseMatrix<double> matrix_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace bespoke
