#include "bespoke/rigid/nearest_rotation.h"

#include <Eigen/SVD>

namespace bespoke {

// The polar rotation by singular values, with det = +1 (Arun, Huang, Blostein 1987; Umeyama 1991).
NearestRotation nearest_rotation(const Matrix3& matrix) {
  const Eigen::JacobiSVD<Matrix3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3 sign = Vector3::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign[2] = -1;
  NearestRotation nearest;
  nearest.rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  nearest.trace = svd.singularValues().dot(sign);
  return nearest;
}

}  // namespace bespoke
