#include "bespoke/rigid/rigid_alignment.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "bespoke/error.h"
#include "bespoke/principal_widths.h"
#include "bespoke/rigid/nearest_rotation.h"

namespace bespoke {
namespace {

void require_pairs(const Points& source, const Points& target, const Eigen::VectorXd& weights) {
  if (source.cols() != target.cols() || source.cols() != weights.size())
    throw InvalidInput("rigid alignment: " + std::to_string(source.cols()) + " source points, " +
                       std::to_string(target.cols()) + " target points and " +
                       std::to_string(weights.size()) + " weights; the three numbers must be equal");
  if (source.cols() < 3)
    throw InvalidInput("rigid alignment needs 3 anchor pairs that are not collinear; there are " +
                       std::to_string(source.cols()));
  for (Eigen::Index i = 0; i < source.cols(); ++i) {
    if (!source.col(i).allFinite() || !target.col(i).allFinite())
      throw InvalidInput("rigid alignment: anchor pair " + std::to_string(i) +
                         " has a coordinate that is not finite");
    if (!(weights[i] > 0))
      throw InvalidInput("rigid alignment: weight " + std::to_string(weights[i]) + " of anchor pair " +
                         std::to_string(i) + " must be positive");
  }
}

/// Sum 1; an infinite weight counts as the largest finite one times 1e6.
Eigen::VectorXd finite_weights(const Eigen::VectorXd& weights) {
  constexpr double infinite_over_finite = 1e6;
  double largest = 0;
  for (const double weight : weights)
    if (std::isfinite(weight)) largest = std::max(largest, weight);
  if (largest == 0) return Eigen::VectorXd::Constant(weights.size(), 1.0 / double(weights.size()));
  Eigen::VectorXd result(weights.size());
  for (Eigen::Index i = 0; i < weights.size(); ++i)
    result[i] = std::isfinite(weights[i]) ? weights[i] / largest : infinite_over_finite;
  return result / result.sum();
}

void require_not_collinear(const Points& points, const char* which) {
  constexpr double smallest_ratio = 1e-9;
  const Vector3 widths = principal_widths(points).widths;
  if (widths[1] > smallest_ratio * widths[0]) return;
  const std::string shape = widths[0] > 0 ? "collinear" : "all at one place";
  throw InvalidInput("rigid alignment: the " + std::to_string(points.cols()) + " anchor points on the " +
                     which + " are " + shape +
                     ", so the rotation is not determined; add an anchor off their line");
}

}  // namespace

RigidTransform align_rigidly(const Points& source, const Points& target, const Eigen::VectorXd& weights) {
  require_pairs(source, target, weights);
  require_not_collinear(source, "source");
  require_not_collinear(target, "target");
  const Eigen::VectorXd w = finite_weights(weights);
  const Vector3 source_centre = source * w;
  const Vector3 target_centre = target * w;
  const Points centred_source = source.colwise() - source_centre;
  const Points centred_target = target.colwise() - target_centre;

  // Eq. 4–6: the rotation that maximises tr(R · Σ w q q'ᵀ).
  const Matrix3 covariance = centred_target * w.asDiagonal() * centred_source.transpose();
  const Matrix3 rotation = nearest_rotation(covariance).rotation;
  return {rotation, target_centre - rotation * source_centre};
}

}  // namespace bespoke
