#include "bespoke/rigid/similarity_alignment.h"

#include <Eigen/Dense>

#include "bespoke/error.h"

namespace bespoke {

Similarity align_similarly(const Points& source, const Points& target, const Eigen::VectorXd& weights) {
  const double total = weights.sum();
  const Vector3 source_mean = source * weights / total, target_mean = target * weights / total;
  const Points x = source.colwise() - source_mean, y = target.colwise() - target_mean;
  const double spread = (x.colwise().squaredNorm() * weights).value();
  if (!(spread > 0)) throw InvalidInput("a similarity needs source points that do not coincide");
  const Matrix3 covariance = y * weights.asDiagonal() * x.transpose();
  const Eigen::JacobiSVD<Matrix3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3 sign = Vector3::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign[2] = -1;
  Similarity result;
  result.rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  result.scale = svd.singularValues().dot(sign) / spread;
  if (!(result.scale > 0)) throw InvalidInput("a similarity needs target points that do not coincide");
  result.translation = target_mean - result.scale * (result.rotation * source_mean);
  return result;
}

}  // namespace bespoke
