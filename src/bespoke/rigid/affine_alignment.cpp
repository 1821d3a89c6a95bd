#include "bespoke/rigid/affine_alignment.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <string>

#include "bespoke/error.h"

namespace bespoke {
namespace {

/// The linear map X of least norm with X · spread = cross, by the SVD of the normal matrix.
Matrix3 solve_above_width(const Points& arms, const Points& change) {
  constexpr double smallest_ratio = 1e-12;
  Eigen::JacobiSVD<Matrix3> svd(Matrix3(arms * arms.transpose()), Eigen::ComputeFullU | Eigen::ComputeFullV);
  svd.setThreshold(smallest_ratio);
  if (!(svd.singularValues()[0] > 0)) return Matrix3::Zero();
  return svd.solve(Matrix3(arms * change.transpose())).transpose();
}

/// The same with the rank that a pivoted factorisation finds in working precision.
Matrix3 solve_above_rounding(const Points& arms, const Points& change) {
  const Matrix3 spread = arms * arms.transpose();
  const Matrix3 cross = change * arms.transpose();
  const Matrix3 inverse = spread.completeOrthogonalDecomposition().pseudoInverse();
  return cross * inverse;
}

}  // namespace

AffineMap align_affinely(const Points& source, const Points& target, FlatDirections flat) {
  if (source.cols() != target.cols() || source.cols() == 0)
    throw InvalidInput("affine alignment: " + std::to_string(source.cols()) + " source points and " +
                       std::to_string(target.cols()) + " target points; the numbers must be equal and not 0");
  const Vector3 source_centre = source.rowwise().mean();
  const Vector3 target_centre = target.rowwise().mean();
  const Points arms = source.colwise() - source_centre;
  // Of the change, so that its solution of least norm is the least change.
  const Points change = (target.colwise() - target_centre) - arms;
  AffineMap map;
  map.linear += flat == FlatDirections::of_rounding ? solve_above_rounding(arms, change)
                                                    : solve_above_width(arms, change);
  map.offset = target_centre - map.linear * source_centre;
  return map;
}

}  // namespace bespoke
