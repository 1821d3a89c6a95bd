#include "bespoke/elastic/detail/preconditioned_bfgs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/random_points.h"

namespace bespoke {
namespace {

TEST(Minimise, FindsTheMinimumOfABadlyScaledQuadratic) {
  const Eigen::Index count = 200;
  const Points middle = test::random_points(count, 1);
  const Eigen::VectorXd stiffness = Eigen::VectorXd::LinSpaced(count, 0, 12).array().exp();
  const Energy energy = [&](const Points& x, Points& gradient) {
    gradient = (x - middle) * stiffness.asDiagonal();
    return gradient.cwiseProduct(x - middle).sum() / 2;
  };
  Points x = Points::Zero(3, count);
  const int iterations = minimise(
      energy, [&]() -> Eigen::VectorXd { return stiffness.cwiseInverse(); }, {100, 1e-12}, x);
  EXPECT_LT((x - middle).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT(iterations, 30);
}

TEST(Minimise, NeverLeavesWhereTheEnergyIsFinite) {
  // Σ x² − log-like barrier at x > 0.5: the minimum of the quadratic lies beyond it.
  bool left = false;
  const Energy energy = [&](const Points& x, Points& gradient) {
    if (!(x.array() > 0.5).all()) return std::numeric_limits<double>::infinity();
    const Eigen::Array3Xd above = x.array() - 0.5;
    gradient = (2 * x.array() - 1e-3 / above.square()).matrix();
    return x.squaredNorm() + 1e-3 * above.inverse().sum();
  };
  Points x = Points::Constant(3, 10, 4);
  minimise(
      energy, [] { return Eigen::VectorXd::Constant(10, 0.5).eval(); }, {100, 1e-9}, x);
  left = !(x.array() > 0.5).all();
  EXPECT_FALSE(left);
  EXPECT_LT(x.maxCoeff(), 0.56);
}

TEST(Minimise, StaysAtAMinimum) {
  const Energy energy = [](const Points& x, Points& gradient) {
    gradient = x;
    return x.squaredNorm() / 2;
  };
  Points x = Points::Zero(3, 5);
  minimise(
      energy, [] { return Eigen::VectorXd::Ones(5).eval(); }, {10, 1e-3}, x);
  EXPECT_EQ(x, Points::Zero(3, 5));
}

}  // namespace
}  // namespace bespoke
