#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "bespoke/clearance/detail/correction_graph.h"
#include "bespoke/types.h"

namespace bespoke {

/// A displacement a row.
using NodeVectors = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Edges from a place that misses its distance within which all that moves lies.
inline constexpr int reach_in_edges = 5;

/// The energy of a displacement u of the nodes,
///   ½ Σᵢ dᵢ |uᵢ + ρ² (uᵢ − mean of its neighbours)|²,   dᵢ the sum of the weights at i,
/// amount, stretch and bending in one: ½ ∫ |u − ℓ² Δu|² in the metric of the edges, with the umbrella
/// operator as Δ (Kobbelt, Campagna, Vorsatz, Seidel 1998). Its matrix is H D⁻¹ H with H = D + ρ² (D − W);
/// H is factored once a product.
class SmoothCorrection {
 public:
  /// Throws SolverError where the factorisation fails.
  explicit SmoothCorrection(const CorrectionGraph& graph);

  /// Nodes, and what the factor needs for them: flags in its order.
  using SomeNodes = std::vector<char>;
  SomeNodes all_nodes() const;
  /// Those with an entry in a row of `places` (k×m).
  SomeNodes nodes_of(const Eigen::SparseMatrix<double, Eigen::RowMajor>& places) const;

  /// The displacements of least energy under forces at the nodes: (H D⁻¹ H)⁻¹ f. Of other nodes than these
  /// they mean nothing.
  NodeVectors operator()(const NodeVectors& forces, const SomeNodes& nodes) const;
  /// The same of one number a node.
  Eigen::VectorXd operator()(const Eigen::VectorXd& forces) const;

 private:
  Eigen::VectorXd degree_;
  std::unique_ptr<const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>> factor_;
};

/// g · (B u) ≥ c, a row of B a constraint.
struct LinearConstraints {
  Eigen::SparseMatrix<double, Eigen::RowMajor> places;  ///< B: k×m
  NodeVectors gradients;                                ///< g: k×3
  Eigen::VectorXd amounts;                              ///< c: k
};

/// The u of least energy that meets the constraints, from its dual: accelerated projected gradients (Nesterov
/// 1983; restarts of O'Donoghue and Candès 2015), a step a constraint from the sum of its row (Gershgorin).
/// `multipliers`: where to start, k; and where it ended. Stops when none is missed by more than `tolerance`,
/// or after `iterations`, so that constraints that contradict each other end in a compromise.
NodeVectors minimised_energy(const SmoothCorrection& energy, const LinearConstraints& constraints,
                             double tolerance, int iterations, Eigen::VectorXd& multipliers);

}  // namespace bespoke
