#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A point of the surface whose displacement is requested: Σ weights[k] · T(vertices[k]).
struct DisplacementAnchor {
  Eigen::Vector3i vertices;
  Vector3 barycentric;  ///< sum 1
  double weight = 0;    ///< > 0, no unit; a vertex's own data term has weight 1
};

/// Eq. 11–13: smooth displacements T near the observed ones T⁰, the minimum of
///   Σᵢ |Tᵢ − T⁰ᵢ|² + s Σ_edges |Tᵢ − Tⱼ|² + Σ_anchors w |T(anchor) − T⁰_anchor|²,
/// which is the solution of (I + L) T = T⁰ (Eq. 13) with L = s·(umbrella operator, each row times its
/// valence). As printed s is 1 and there are no anchors, whose rows would be added to L. The matrix is
/// constant, so it is factored once. Thread-safe.
class DisplacementSmoother {
 public:
  /// stiffness: s, ≥ 0, no unit. Throws InvalidInput, or SolverError when the factorisation fails.
  DisplacementSmoother(const TriangleMesh& mesh, const std::vector<DisplacementAnchor>& anchors,
                       double stiffness);

  /// wished: T⁰, 3×n, mesh units, 0 where `matched` is 0: such a vertex has no data term and follows its
  /// neighbours (its first term is left out of the energy). anchor_wished: 3×k.
  Points solve(const Points& wished, const std::vector<char>& matched, const Points& anchor_wished) const;

 private:
  std::vector<DisplacementAnchor> anchors_;
  Eigen::SparseMatrix<double> matrix_;  // I + L
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace bespoke
