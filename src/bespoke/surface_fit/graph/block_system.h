#pragma once

#include <optional>
#include <vector>

#include "bespoke/rbf/elimination_tree.h"
#include "bespoke/rbf/front_cholesky.h"
#include "bespoke/surface_fit/graph/deformation_nodes.h"
#include "bespoke/types.h"

namespace bespoke {

/// Sparse symmetric positive definite system of 3×3 blocks with one fixed pattern: the symbolic factorisation
/// is done once, the numbers change. Not thread-safe.
class BlockSystem {
 public:
  /// adjacency[i]: the columns that row i may hold, in any order, repeats allowed; made symmetric by the
  /// caller. The diagonal is always there. places: 3×n, of the unknowns: nested dissection orders them by
  /// these.
  BlockSystem(std::vector<std::vector<int>> adjacency, const Points& places);
  BlockSystem(const BlockSystem&) = delete;
  BlockSystem& operator=(const BlockSystem&) = delete;

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

  /// A M⁻¹ Aᵀ of the matrix M last solved, A the combination of 3×3 unit blocks: what a unit force there
  /// moves.
  Matrix3 compliance(const std::vector<NodeWeight>& combination) const;

 private:
  Matrix3& at(int row, int column);
  /// Unknowns that one is coupled with, itself included.
  std::size_t width(int unknown) const {
    return (graph_.start[3 * unknown + 1] - graph_.start[3 * unknown]) / 3;
  }

  struct Entries {
    std::size_t column, row;  // the first of a block's column, and of its transpose's, in values_
  };

  std::vector<int> start_;  // of each block column, in rows_ and blocks_
  std::vector<int> rows_;   // increasing in a column, the diagonal first
  std::vector<Matrix3> blocks_;
  std::vector<Entries> entries_;  // of each block
  Eigen::VectorXd right_side_;
  RadiusGraph graph_;  // of the scalar unknowns
  EliminationTree tree_;
  std::vector<double> values_;  // of the graph's entries
  std::optional<FrontCholesky> factor_;
};

}  // namespace bespoke
