#include "bespoke/rbf/global_rbf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

using testing::HasSubstr;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Eigen::VectorXd exact(Eigen::Index count) { return Eigen::VectorXd::Constant(count, infinite); }

double extent(const Points& points) {
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

std::string refusal(const Points& sources, const Points& targets, const Eigen::VectorXd& weights) {
  return test::error_message<InvalidInput>([&] { GlobalRbf(sources, targets, weights); });
}

TEST(GlobalRbf, InterpolatesTheAnchors) {
  for (const int count : {4, 5, 9, 60, 400})
    for (const double unit : {1e-3, 1.0, 1e4}) {
      const Points sources = unit * test::random_points(count, 1);
      const Points targets = sources + 0.3 * unit * test::random_points(count, 2);
      const GlobalRbf warp(sources, targets, exact(count));
      EXPECT_LT((warp(sources) - targets).colwise().norm().maxCoeff(), 1e-9 * extent(sources));
    }
}

TEST(GlobalRbf, InterpolatesAnchorsThatNearlyTouchFarFromTheOrigin) {
  Points sources = test::random_points(30, 3);
  sources.col(7) = sources.col(3) + Vector3(1e-3, 0, 0);
  const Points targets = sources + 0.1 * sources.array().sin().matrix();
  const Vector3 away(100, 200, -50);
  const GlobalRbf warp(sources.colwise() + away, targets, exact(30));
  EXPECT_LT((warp(sources.colwise() + away) - targets).colwise().norm().maxCoeff(), 1e-9 * extent(sources));
}

TEST(GlobalRbf, ReportsTheResidualWhenNearlyTouchingAnchorsPartWays) {
  Points sources = test::random_points(30, 3);
  Points targets = sources;
  sources.col(7) = sources.col(3) + Vector3(1e-6, 0, 0);
  targets.col(7).setConstant(2);
  EXPECT_THROW(GlobalRbf(sources, targets, exact(30)), SolverError);
}

TEST(GlobalRbf, ReproducesAffineMapsEverywhere) {
  AffineMap map;
  map.linear << 2, 1, 0, -1, 1, 3, 0.5, 0, 1;
  map.offset << 4, 5, -6;
  const Points x = 3 * test::random_points(200, 5);
  for (const double weight : {infinite, 10.0}) {
    const Points sources = test::random_points(20, 6);
    const GlobalRbf warp(sources, map * sources, Eigen::VectorXd::Constant(20, weight));
    EXPECT_LT((warp(x) - map * x).colwise().norm().maxCoeff(), 1e-10);
    EXPECT_LT((warp.affine().linear - map.linear).norm(), 1e-11);
  }
}

TEST(GlobalRbf, FourAnchorsGiveTheirAffineMap) {
  Points sources(3, 4);
  sources << Vector3::Zero(), Matrix3::Identity();
  const Points targets = test::random_points(4, 7);
  const GlobalRbf warp(sources, targets, exact(4));
  EXPECT_LT((warp(Points(Vector3(0.25, 0.25, 0.25))) - targets.rowwise().mean()).norm(), 1e-14);
}

TEST(GlobalRbf, IsEquivariantUnderRigidMotionOfTheSource) {
  const Points sources = test::random_points(15, 8);
  const Points targets = test::random_points(15, 9);
  const Points x = test::random_points(50, 10);
  const Matrix3 rotation = test::random_rotation(11);
  const GlobalRbf warp(sources, targets, exact(15));
  const GlobalRbf turned(rotation * sources, targets, exact(15));
  EXPECT_LT((turned(rotation * x) - warp(x)).norm(), 1e-10);
}

TEST(GlobalRbf, FiniteWeightsSmoothTowardsTheAffineLeastSquaresFit) {
  const Points sources = test::random_points(25, 12);
  const Points targets = sources + 0.2 * test::random_points(25, 13);
  double previous = 0;
  for (const double weight : {1e9, 1e3, 1e1, 1e-1}) {
    const GlobalRbf warp(sources, targets, Eigen::VectorXd::Constant(25, weight));
    const double residual = (warp(sources) - targets).norm();
    EXPECT_GT(residual, previous);
    previous = residual;
  }
  Eigen::MatrixX4d tail(25, 4);
  tail << Eigen::VectorXd::Ones(25), sources.transpose();
  const Eigen::Matrix<double, 4, 3> fit = tail.householderQr().solve(Eigen::MatrixX3d(targets.transpose()));
  const GlobalRbf softest(sources, targets, Eigen::VectorXd::Constant(25, 1e-9));
  EXPECT_LT((softest.affine().linear - fit.bottomRows<3>().transpose()).norm(), 1e-6);
}

TEST(GlobalRbf, MeetsExactAnchorsAmongSoftOnes) {
  const Points sources = test::random_points(20, 14);
  const Points targets = sources + 0.2 * test::random_points(20, 15);
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(20, 1.0);
  weights.head(10).setConstant(infinite);
  const GlobalRbf warp(sources, targets, weights);
  const Eigen::RowVectorXd residuals = (warp(sources) - targets).colwise().norm();
  EXPECT_LT(residuals.head(10).maxCoeff(), 1e-9);
  EXPECT_GT(residuals.tail(10).minCoeff(), 1e-6);
}

TEST(GlobalRbf, WeightsHaveNoUnit) {
  const Points sources = test::random_points(20, 16);
  const Points targets = sources + 0.2 * test::random_points(20, 17);
  const Eigen::VectorXd weights = Eigen::VectorXd::Constant(20, 5.0);
  const Points x = test::random_points(10, 18);
  const GlobalRbf metres(sources, targets, weights);
  const GlobalRbf millimetres(1000 * sources, 1000 * targets, weights);
  EXPECT_LT((millimetres(1000 * x) / 1000 - metres(x)).norm(), 1e-11);
}

TEST(GlobalRbf, NamesTheDeficientDirectionOfCoplanarAnchors) {
  const Vector3 normal = Vector3(0, 0.6, 0.8);
  Points sources = test::random_points(8, 19);
  sources -= normal * (normal.transpose() * sources);
  sources.colwise() += Vector3(1, 2, 3);
  const std::string message = refusal(sources, sources, exact(8));
  EXPECT_THAT(message, HasSubstr("coplanar"));
  EXPECT_THAT(message, HasSubstr("0.6"));
  EXPECT_THAT(message, HasSubstr("0.8"));
  Points nearly = sources;
  nearly.col(0) += 1e-9 * normal;
  EXPECT_THAT(refusal(nearly, sources, exact(8)), HasSubstr("coplanar"));
}

// The middle of the bounding box of points on a slanted plane lies off that plane.
TEST(GlobalRbf, RefusesCoplanarAnchorsOnAnySlant) {
  const Vector3 normal = Vector3(1, 2, 2) / 3;
  Points sources = test::random_points(8, 21);
  sources -= normal * (normal.transpose() * sources);
  const std::string message = refusal(sources, sources, exact(8));
  EXPECT_THAT(message, HasSubstr("coplanar"));
  EXPECT_THAT(message, HasSubstr("0.3333"));
}

TEST(GlobalRbf, RefusesUnusableAnchors) {
  const Points points = test::random_points(6, 20);
  EXPECT_THAT(refusal(points.leftCols(3), points.leftCols(3), exact(3)), HasSubstr("there are 3"));
  EXPECT_THAT(refusal(points, points.leftCols(5), exact(6)), HasSubstr("must be equal"));
  EXPECT_THAT(refusal(Points(3, 0), Points(3, 0), exact(0)), HasSubstr("there are 0"));
  Points twice = points;
  twice.col(5) = twice.col(1);
  EXPECT_THAT(refusal(twice, points, exact(6)), HasSubstr("1 and 5"));
  Points broken = points;
  broken(0, 4) = nan;
  EXPECT_THAT(refusal(broken, points, exact(6)), HasSubstr("pair 4"));
  EXPECT_THAT(refusal(points, broken, exact(6)), HasSubstr("pair 4"));
  EXPECT_THAT(refusal(points, points, -exact(6)), HasSubstr("weight"));
}

}  // namespace
}  // namespace bespoke
