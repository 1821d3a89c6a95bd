#include "bespoke/rbf/layer_solver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bespoke/rbf/kernels.h"
#include "bespoke/rbf/rbf_layer.h"

namespace bespoke {
namespace {

/// Points of a cubic lattice of spacing 1, moved a little; the same every time.
Points uneven_lattice(int n) {
  Points points(3, n * n * n);
  for (int i = 0; i < points.cols(); ++i) {
    const Vector3 place(i % n, i / n % n, i / (n * n));
    points.col(i) = place + 0.2 * Vector3(std::sin(3.0 * i), std::sin(5.0 * i), std::sin(7.0 * i));
  }
  return points;
}

/// What the functions of a layer add up to at the centres.
template <class Kernel>
Points at_centers(const Points& centers, const Points& coefficients, double lambda) {
  Points sums = Points::Zero(3, centers.cols());
  for (Eigen::Index i = 0; i < centers.cols(); ++i)
    for (Eigen::Index j = 0; j < centers.cols(); ++j)
      sums.col(i) += Kernel::value((centers.col(i) - centers.col(j)).norm() / lambda) * coefficients.col(j);
  return sums;
}

Points waves(const Points& centers) {
  Points values(3, centers.cols());
  for (Eigen::Index i = 0; i < centers.cols(); ++i) values.col(i) = (0.7 * centers.col(i)).array().cos();
  return values;
}

TEST(SolveLayer, TakesItsValuesWithinTheTolerance) {
  const Points centers = uneven_lattice(6), values = waves(centers);
  const RbfLayer layer = solve_layer(centers, values, 3, 0);
  const Points left = at_centers<WendlandC2>(centers, layer.coefficients, 3) - values;
  EXPECT_LE(left.colwise().norm().maxCoeff(), 1.01e-3 * values.colwise().norm().maxCoeff());
}

TEST(SmoothLayer, TakesItsValuesUpToTheRidge) {
  const Points centers = uneven_lattice(6), values = waves(centers);
  const SmoothLayerOptions options{.ridge = 0.1, .max_steps = 200, .residual = 1e-12};
  const Points coefficients = smooth_layer(centers, values, 2.5, options);
  const Points left = at_centers<WendlandC4>(centers, coefficients, 2.5) + 0.1 * coefficients - values;
  EXPECT_LE(left.norm(), 1e-5 * values.norm());
}

TEST(SmoothLayer, StopsAfterItsSteps) {
  const Points centers = uneven_lattice(4), values = waves(centers);
  const Points none = smooth_layer(centers, values, 2.5, {.max_steps = 0});
  EXPECT_EQ(none, Points(Points::Zero(3, centers.cols())));
}

}  // namespace
}  // namespace bespoke
