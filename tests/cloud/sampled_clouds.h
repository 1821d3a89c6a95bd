#pragma once

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "bespoke/cloud/oriented_points.h"
#include "support/random_points.h"

namespace bespoke::test {

/// Even points of the unit sphere with exact normals.
inline OrientedPoints sphere_cloud(Eigen::Index count) {
  const Points points = sphere_points(count);
  return {points, points};
}

/// Even points, each for the same area, of the torus about z with radii 1 and 0.4, with exact normals.
inline OrientedPoints torus_cloud(Eigen::Index count) {
  const double tube = 0.4, golden = (std::sqrt(5.) - 1) / 2;
  OrientedPoints cloud{Points(3, count), Points(3, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    // Area up to the angle v around the tube is proportional to v + tube sin v.
    const double share = 2 * std::numbers::pi * (double(i) + 0.5) / double(count);
    double v = share;
    for (int step = 0; step < 50; ++step) v -= (v + tube * std::sin(v) - share) / (1 + tube * std::cos(v));
    const double u = 2 * std::numbers::pi * golden * double(i);
    cloud.normals.col(i) = Vector3(std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v));
    cloud.points.col(i) = Vector3(std::cos(u), std::sin(u), 0) + tube * cloud.normals.col(i);
  }
  return cloud;
}

inline double distance_from_torus(const Vector3& x) {
  return std::abs(std::hypot(std::hypot(x.x(), x.y()) - 1, x.z()) - 0.4);
}

inline OrientedPoints chosen(const OrientedPoints& cloud, const std::vector<int>& columns) {
  return {cloud.points(Eigen::all, columns), cloud.normals(Eigen::all, columns)};
}

template <class Keep>
OrientedPoints filtered(const OrientedPoints& cloud, const Keep& keep) {
  std::vector<int> kept;
  for (int i = 0; i < cloud.points.cols(); ++i)
    if (keep(cloud.points.col(i))) kept.push_back(i);
  return chosen(cloud, kept);
}

inline OrientedPoints shuffled(const OrientedPoints& cloud, unsigned seed) {
  std::vector<int> order(static_cast<std::size_t>(cloud.points.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return chosen(cloud, order);
}

/// Points moved along their normals and normals tilted, by independent Gaussians.
inline OrientedPoints noisy(OrientedPoints cloud, double sigma, double tilt, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> gaussian;
  for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
    cloud.points.col(i) += sigma * gaussian(generator) * cloud.normals.col(i);
    for (int axis = 0; axis < 3; ++axis) cloud.normals(axis, i) += tilt * gaussian(generator);
  }
  return cloud;
}

}  // namespace bespoke::test
