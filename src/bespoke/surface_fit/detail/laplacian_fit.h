#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {

/// A point of the surface whose displacement is asked for: Σ weights[k] · T(vertices[k]).
struct DisplacementAnchor {
  Eigen::Vector3i vertices;
  Vector3 barycentric;  ///< sum 1
  double weight = 0;    ///< > 0, no unit; a vertex's own wish has weight 1
};

/// Eq. 11–13: smooth displacements T near the wished ones T⁰, the minimum of
///   Σᵢ |Tᵢ − T⁰ᵢ|² + s Σ_edges |Tᵢ − Tⱼ|² + Σ_anchors w |T(anchor) − T⁰_anchor|²,
/// which is the solution of (I + L) T = T⁰ with L = s·(umbrella operator, each row times its valence) plus
/// the anchors' rows. The matrix is constant, so it is factored once. Thread-safe.
class DisplacementSmoother {
 public:
  /// stiffness: s, ≥ 0, no unit. Throws InvalidInput, or SolverError when the factorisation fails.
  DisplacementSmoother(const TriangleMesh& mesh, const std::vector<DisplacementAnchor>& anchors,
                       double stiffness);

  /// wished: 3×n, mesh units, 0 where `matched` is 0: such a vertex has no wish of its own and follows its
  /// neighbours (its first term is left out of the energy). anchor_wished: 3×k.
  Points solve(const Points& wished, const std::vector<char>& matched, const Points& anchor_wished) const;

 private:
  std::vector<DisplacementAnchor> anchors_;
  Eigen::SparseMatrix<double> matrix_;  // I + L
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
};

/// The paper's surface fitting (IV.C): closest compatible points of all vertices, T⁰ towards them, smooth
/// displacements by Eq. 13, move, repeat; at the end every vertex that has a compatible point snaps onto it.
/// Anchors on both surfaces (within 1e-3 of the source's bounding-box diagonal) hold their places through
/// terms of their own. Input and errors as fit_surface.
SurfaceFit fit_surface_laplacian(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                                 const Progress& progress = {});

}  // namespace bespoke
