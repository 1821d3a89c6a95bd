#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "bespoke/progress.h"
#include "bespoke/rbf/elimination_tree.h"

namespace bespoke {

/// Cholesky factor of a symmetric positive definite matrix with the pattern of a radius graph, front by front
/// with dense kernels (Duff and Reid's multifrontal method).
///
/// Seconds of CPU and MB for ordering, factor and the six solves of a fit, λ in % of the
/// diagonal:
///
///     model    centres  λ  entries a row   this        SimplicialLLT   CHOLMOD
///     shoe       4,448  3     40           0.06   10    0.08   12      0.07  11
///     dress      7,297  3     96           0.26   35    0.32   40      0.23  30
///     girths    10,526  3    135           0.62   48    0.60   90      0.47  57
///     glove      5,594  5    111           0.24   31    0.65   35      0.28  28
///     girths    10,526  5    338           1.39  144    2.26  208      0.94 109
///     body d01  13,380  3    602           3.2   171   22.2   457      3.1  252
///     body d01  13,380  5  1,218           8.3   244      –     –      6.4  448
///
/// Eigen's column by column factor falls behind with the entries of a row. CHOLMOD (5.12, supernodal, with
/// OpenBLAS) is up to a third faster, but that part of it is under the GPL, which this library is not
/// (cholesky_benchmark, with Debian's libsuitesparse-dev; two busy cores, so the digits are rough).
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
