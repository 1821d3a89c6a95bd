#include "bespoke/rigid/regularised_alignment.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr double min_width_ratio = 1e-7;  // of the widest: thinner directions are rounding

/// Of residuals (3×n) with weights of sum 1: the larger of that of a coordinate and of that along a unit
/// vector. freedom: the share of the residuals that no slope has taken.
double standard_deviation(const Points& residuals, const Eigen::VectorXd& weights, const Vector3& along,
                          double freedom) {
  const double mean = (residuals.colwise().squaredNorm() * weights).value() / 3;
  const double one = ((along.transpose() * residuals).array().square().matrix() * weights).value();
  return std::sqrt(std::max(mean, one) / freedom);
}

void require_weighted_pairs(const Points& source, const Points& target, const Eigen::VectorXd& weights) {
  if (source.cols() != target.cols() || source.cols() != weights.size() || source.cols() < 3)
    throw InvalidInput("a regularised alignment needs three pairs of points at least, and their weights");
  if (!((weights.array() > 0).all() && weights.allFinite()))
    throw InvalidInput("the weights of a regularised alignment must be above 0 and finite");
}

}  // namespace

// Ridge regression (Hoerl, Kennard 1970), direction by direction.
RegularisedAlignment align_regularised(const Points& source, const Points& target,
                                       const Eigen::VectorXd& weights) {
  require_weighted_pairs(source, target, weights);
  const Eigen::VectorXd shares = weights / weights.sum();
  RegularisedAlignment result;
  result.similarity = align_similarly(source, target, shares);
  result.source_centre = source * shares;
  const Points arms = source.colwise() - result.source_centre;
  const Eigen::SelfAdjointEigenSolver<Matrix3> principal(
      Matrix3(arms * shares.asDiagonal() * arms.transpose()));
  result.directions = principal.eigenvectors().rowwise().reverse();
  result.widths = principal.eigenvalues().reverse().cwiseMax(0).cwiseSqrt();
  const double scale = result.similarity.scale, count = 1 / shares.squaredNorm();

  Points left = target - result.similarity * source;
  result.affine.linear = scale * result.similarity.rotation;
  for (int k = 0; k < 3; ++k) {
    if (!(result.widths[k] > min_width_ratio * result.widths[0])) break;
    const Vector3 direction = result.directions.col(k);
    const double variance = result.widths[k] * result.widths[k];
    const double freedom = std::max(1.0, count - 1 - k) / count;
    // Without the slope in question: with it nothing may be left to measure.
    const double misfit =
        standard_deviation(left, shares, result.similarity.rotation * direction, freedom) / scale;
    const Eigen::RowVectorXd places = direction.transpose() * arms;
    const Vector3 slope = left * shares.asDiagonal() * places.transpose() / variance;
    result.determined[k] = variance / (variance + misfit * misfit);
    result.affine.linear += result.determined[k] * slope * direction.transpose();
    left -= slope * places;
  }
  result.affine.offset = target * shares - result.affine.linear * result.source_centre;
  return result;
}

Points reflected(const RegularisedAlignment& alignment, const Points& x) {
  const Vector3 normal = alignment.directions.col(2);
  return x - 2 * normal * (normal.transpose() * (x.colwise() - alignment.source_centre));
}

}  // namespace bespoke
