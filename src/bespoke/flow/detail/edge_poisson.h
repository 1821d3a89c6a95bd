#pragma once

#include <memory>
#include <vector>

#include "bespoke/flow/detail/face_rotations.h"

namespace bespoke {

/// The surface whose edges come closest to given gradients: least squares of
/// Σ_faces Σ_edges cot α |(xᵢ − xⱼ) − G (vᵢ − vⱼ)|², α the angle opposite the edge (the Poisson equation of
/// the cotangent Laplacian; Xu, Zhang, Wang, Bao 2005). Gradients of a real deformation are met exactly. The
/// normal matrix does not depend on G and is factored once.
class EdgePoisson {
 public:
  /// areas: m, faces with 0 take no part. pinned: one vertex of every piece that the other faces connect,
  /// each of which comes to lie at the origin. Throws SolverError.
  EdgePoisson(const TriangleMesh& source, const Eigen::VectorXd& areas, const std::vector<int>& pinned);
  ~EdgePoisson();

  /// 3×n for the gradients of `rotations` at t.
  Points solve(const FaceRotations& rotations, double t) const;

 private:
  struct Factor;
  TriangleMesh source_;
  Eigen::Matrix3Xd weights_;  // of the edge opposite each corner, per face
  std::unique_ptr<const Factor> factor_;
};

}  // namespace bespoke
