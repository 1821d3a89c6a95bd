#include "bespoke/principal_widths.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>

namespace bespoke {

// A singular value decomposition of the triangular factor, for that has one size: Eigen's of 3×n takes a
// quarter of a minute to compile.
PrincipalWidths principal_widths(const Points& points) {
  Eigen::MatrixX3d rows = Eigen::MatrixX3d::Zero(std::max<Eigen::Index>(points.cols(), 3), 3);
  rows.topRows(points.cols()) = (points.colwise() - points.rowwise().mean()).transpose();
  const Matrix3 factor = rows.householderQr().matrixQR().topRows<3>().triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Matrix3> svd(factor, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

}  // namespace bespoke
