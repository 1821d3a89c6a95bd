#pragma once

#include <random>

#include "bespoke/types.h"

namespace bespoke::test {

/// 3×n, every coordinate uniform in [-1, 1].
inline Points random_points(Eigen::Index count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  return Points::NullaryExpr(3, count, [&] { return coordinate(generator); });
}

/// Uniform over all rotations.
inline Matrix3 random_rotation(unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> component;
  Eigen::Quaterniond quaternion;
  quaternion.coeffs() = Eigen::Vector4d::NullaryExpr([&] { return component(generator); });
  return quaternion.normalized().toRotationMatrix();
}

/// Points of a spiral that covers the unit sphere evenly, spacing about 3.5 / √count.
inline Points sphere_points(Eigen::Index count) {
  const double golden_angle = 2.399963229728653;
  Points points(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double z = 1 - (2 * double(i) + 1) / double(count);
    const double radius = std::sqrt(1 - z * z);
    points.col(i) =
        Vector3(radius * std::cos(golden_angle * double(i)), radius * std::sin(golden_angle * double(i)), z);
  }
  return points;
}

}  // namespace bespoke::test
