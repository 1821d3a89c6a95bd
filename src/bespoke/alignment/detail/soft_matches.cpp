#include "bespoke/alignment/detail/soft_matches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace bespoke {
namespace {

constexpr double normal_deviation = 0.5;    // σ_n: about 30 degrees
constexpr double curvature_unit = 3;        // of curvature × radius: tanh bounds what a sharp ridge can say
constexpr double boundary_deviation = 0.7;  // σ_β: one cut against none costs a factor of e
constexpr double none = 0.0111;             // exp(−3²/2)

constexpr int features = 8;
using Features = Eigen::Matrix<double, features, Eigen::Dynamic>;

/// Columns whose squared distances are the exponents of the likelihood, times −2.
Features features_of(const Points& points, const Points& normals, const SurfacePatches& patches,
                     const Vector3& origin, double length) {
  Features all(features, points.cols());
  all.topRows<3>() = (points.colwise() - origin) / length;
  all.middleRows<3>(3) = normals / normal_deviation;
  all.row(6) = (patches.curvature.array() / curvature_unit).tanh().transpose();
  all.row(7) = patches.on_boundary.transpose() / boundary_deviation;
  return all;
}

}  // namespace

double SoftMatches::residual(const Points& points) const {
  const double total = weights.sum();
  if (!(total > 0)) return std::numeric_limits<double>::infinity();
  return std::sqrt((targets - points).colwise().squaredNorm().dot(weights) / total);
}

// Expectation step of a Gaussian mixture with an outlier class, in both directions (as in coherent point
// drift, Myronenko, Song 2010).
SoftMatches soft_matches(const SurfacePatches& source, const Points& points, const Points& normals,
                         const SurfacePatches& target, double length) {
  const Features a = features_of(points, normals, source, target.center, length);
  const Features b = features_of(target.points, target.normals, target, target.center, length);
  Eigen::ArrayXXd likelihood = (a.transpose() * b).array();
  likelihood.colwise() -= a.colwise().squaredNorm().transpose().array() / 2;
  likelihood.rowwise() -= b.colwise().squaredNorm().array() / 2;
  likelihood = likelihood.exp();

  // Beside what a patch that lies on the target would find of it within σ.
  const double area = target.spacing * target.spacing * double(target.size());
  const double found_within = 1 / double(target.size()) + 2 * std::numbers::pi * length * length / area;
  const double nothing = none * std::min(1.0, found_within);
  const Eigen::ArrayXd by_source = (likelihood.matrix() * target.open_areas).array() + nothing;
  const Eigen::ArrayXd by_target = (likelihood.matrix().transpose() * source.open_areas).array() + nothing;
  // a_i b_j P_ij (1 / (Σ_j b_j P_ij + none) + 1 / (Σ_i a_i P_ij + none))
  Eigen::ArrayXXd& weights = likelihood;
  const Eigen::ArrayXd row = source.open_areas.array() / by_source;
  for (Eigen::Index j = 0; j < weights.cols(); ++j)
    weights.col(j) *= target.open_areas[j] * (row + source.open_areas.array() / by_target[j]);

  SoftMatches matches;
  matches.weights = weights.rowwise().sum();
  matches.targets = target.points * weights.matrix().transpose();
  const double least = std::numeric_limits<double>::min();
  matches.targets *= matches.weights.cwiseMax(least).cwiseInverse().asDiagonal();
  const Eigen::VectorXd drawn = weights.colwise().sum().transpose();
  const double total = drawn.sum();
  if (!(total > 0)) return matches;
  const Vector3 mean = target.points * drawn / total;
  matches.spread = (target.points.colwise() - mean).colwise().squaredNorm().dot(drawn);
  return matches;
}

}  // namespace bespoke
