#pragma once

#include <Eigen/Sparse>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A face as it lies in the surface, in a frame of its own.
struct RestFace {
  Eigen::Matrix<double, 2, 3> gradients;  ///< of the hat functions of its corners, 1/mm
  double area = 0;                        ///< mm²
};

/// Throws InvalidInput for a face without area.
std::vector<RestFace> rest_faces(const TriangleMesh& mesh);

/// d(flat)/d(surface) of a face, in its frame.
Eigen::Matrix2d face_jacobian(const RestFace& rest, const Eigen::Vector3i& face,
                              const Eigen::Matrix2Xd& flat);

/// Whether every face keeps its orientation.
bool is_unflipped(const TriangleMesh& mesh, const std::vector<RestFace>& rest, const Eigen::Matrix2Xd& flat);

/// n×n: area-weighted products of the gradients, the cotangent Laplacian, positive semidefinite.
Eigen::SparseMatrix<double> stiffness(const TriangleMesh& mesh, const std::vector<RestFace>& rest);

}  // namespace bespoke
