#include "bespoke/elastic/detail/preconditioned_bfgs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/random_points.h"

namespace bespoke {
namespace {

void halved(Points& step) { step /= 2; }

TEST(Minimise, FindsTheMinimumOfABadlyScaledQuadratic) {
  const Eigen::Index count = 200;
  const Points middle = test::random_points(count, 1);
  const Eigen::VectorXd stiffness = Eigen::VectorXd::LinSpaced(count, 0, 12).array().exp();
  const auto energy = [&](const Points& x, Points& gradient) {
    gradient = (x - middle) * stiffness.asDiagonal();
    return gradient.cwiseProduct(x - middle).sum() / 2;
  };
  Points x = Points::Zero(3, count);
  const Objective objective{energy, [&]() -> Eigen::VectorXd { return stiffness.cwiseInverse(); }, halved};
  const int iterations = minimise(objective, {100, 1000, 1e-12}, x);
  EXPECT_LT((x - middle).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT(iterations, 30);
}

TEST(Minimise, NeverLeavesWhereTheEnergyIsFinite) {
  // Σ x² − log-like barrier at x > 0.5: the minimum of the quadratic lies beyond it.
  bool left = false;
  const auto energy = [&](const Points& x, Points& gradient) {
    if (!(x.array() > 0.5).all()) return std::numeric_limits<double>::infinity();
    const Eigen::Array3Xd above = x.array() - 0.5;
    gradient = (2 * x.array() - 1e-3 / above.square()).matrix();
    return x.squaredNorm() + 1e-3 * above.inverse().sum();
  };
  Points x = Points::Constant(3, 10, 4);
  minimise({energy, [] { return Eigen::VectorXd::Constant(10, 0.5).eval(); }, halved}, {100, 1000, 1e-9}, x);
  left = !(x.array() > 0.5).all();
  EXPECT_FALSE(left);
  EXPECT_LT(x.maxCoeff(), 0.56);
}

TEST(Minimise, OneNodeAtItsBoundDoesNotStopTheOthers) {
  // The first node starts at a wall through which its energy pulls it; only its own step is shortened.
  const double wall = 1;
  bool beyond = false;
  const auto energy = [&](const Points& x, Points& gradient) {
    beyond = !(x.col(0).minCoeff() >= wall);
    if (beyond) return std::numeric_limits<double>::infinity();
    gradient = x;
    return x.squaredNorm() / 2;
  };
  const auto damp = [&](Points& step) { step.col(0) *= 1e-3; };
  Points x = Points::Constant(3, 20, 4);
  x.col(0).setConstant(wall + 1e-9);
  minimise({energy, [] { return Eigen::VectorXd::Constant(20, 1).eval(); }, damp}, {30, 200, 1e-9}, x);
  EXPECT_GE(x.col(0).minCoeff(), wall);
  EXPECT_LT(x.rightCols(19).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(Minimise, StaysAtAMinimum) {
  const auto energy = [](const Points& x, Points& gradient) {
    gradient = x;
    return x.squaredNorm() / 2;
  };
  Points x = Points::Zero(3, 5);
  minimise({energy, [] { return Eigen::VectorXd::Ones(5).eval(); }, halved}, {10, 100, 1e-3}, x);
  EXPECT_EQ(x, Points::Zero(3, 5));
}

}  // namespace
}  // namespace bespoke
