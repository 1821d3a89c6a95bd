#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "bespoke/progress.h"
#include "bespoke/rbf/elimination_tree.h"

namespace bespoke {

/// Cholesky factor of a symmetric positive definite matrix with the pattern of a radius graph, front by front
/// with dense kernels (Duff and Reid's multifrontal method).
/// Eigen's column-by-column factor is up to seven times slower; CHOLMOD's supernodal one is up to a third
/// faster, but under the GPL (cholesky_benchmark; tests/accuracy/tuning.md).
class FrontCholesky {
 public:
  /// values: one per entry of the graph. `tree` and `graph` must outlive this. Throws SolverError when a
  /// front is not positive definite to working precision.
  FrontCholesky(const EliminationTree& tree, const RadiusGraph& graph, const std::vector<double>& values,
                const Progress& progress = {});

  /// n×k → n×k.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right_side) const;

 private:
  /// Eliminates the subtree of a front; returns the update of its boundary (lower triangle).
  Eigen::MatrixXd factor(int front);
  void add_entries(const EliminationTree::Front& front, Eigen::MatrixXd& panel) const;
  void add_child(int child, const EliminationTree::Front& front, const Eigen::MatrixXd& child_update,
                 Eigen::MatrixXd& panel, Eigen::MatrixXd& update) const;
  /// Row of a later point in a front: its own points, then its boundary.
  Eigen::Index row(const EliminationTree::Front& front, int point) const;

  const EliminationTree& tree_;
  const RadiusGraph& graph_;
  const std::vector<double>& values_;
  const Progress& progress_;
  std::vector<Eigen::MatrixXd> panels_;  // (own + boundary) × own, lower triangle of the first block
};

}  // namespace bespoke
