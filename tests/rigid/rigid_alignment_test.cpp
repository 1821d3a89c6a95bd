#include "bespoke/rigid/rigid_alignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

using testing::HasSubstr;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Eigen::VectorXd equal_weights(Eigen::Index count) { return Eigen::VectorXd::Constant(count, infinity); }

std::string refusal(const Points& source, const Points& target, const Eigen::VectorXd& weights) {
  return test::error_message<InvalidInput>([&] { align_rigidly(source, target, weights); });
}

void expect_rotation(const Matrix3& rotation) {
  EXPECT_LT((rotation.transpose() * rotation - Matrix3::Identity()).norm(), 1e-14);
  EXPECT_NEAR(rotation.determinant(), 1, 1e-14);
}

TEST(AlignRigidly, RecoversRigidMotions) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const RigidTransform motion{test::random_rotation(seed), test::random_points(1, seed).col(0) * 10};
    const Points source = test::random_points(3 + seed % 7, seed + 100);
    const RigidTransform found = align_rigidly(source, motion * source, equal_weights(source.cols()));
    EXPECT_LT((found.rotation - motion.rotation).norm(), 1e-12);
    EXPECT_LT((found.translation - motion.translation).norm(), 1e-12);
  }
}

TEST(AlignRigidly, RecoversAMotionOfCoplanarPoints) {
  Points source = test::random_points(6, 1);
  source.row(2).setZero();
  const RigidTransform motion{test::random_rotation(2), Vector3(1, 2, 3)};
  const RigidTransform found = align_rigidly(source, motion * source, equal_weights(6));
  EXPECT_LT((found.rotation - motion.rotation).norm(), 1e-13);
}

TEST(AlignRigidly, RecoversAMotionFarFromTheOrigin) {
  const Points source = test::random_points(5, 3).colwise() + Vector3(1e5, -1e5, 1e5);
  const RigidTransform motion{test::random_rotation(4), Vector3(1e5, 0, 0)};
  const RigidTransform found = align_rigidly(source, motion * source, equal_weights(5));
  EXPECT_LT((found * source - motion * source).norm(), 1e-8);
}

TEST(AlignRigidly, NeverReflects) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Points source = test::random_points(8, seed);
    const Points mirrored = Vector3(-1, 1, 1).asDiagonal() * (test::random_rotation(seed) * source);
    expect_rotation(align_rigidly(source, mirrored, equal_weights(8)).rotation);
  }
}

TEST(AlignRigidly, NeverReflectsASymmetricMirrorImage) {
  Points octahedron(3, 6);
  octahedron << Matrix3::Identity(), -Matrix3::Identity();
  expect_rotation(align_rigidly(octahedron, -octahedron, equal_weights(6)).rotation);
  Points corners(3, 4);
  corners << Vector3::Zero(), Matrix3::Identity();
  expect_rotation(align_rigidly(corners, -corners, equal_weights(4)).rotation);
}

TEST(AlignRigidly, IsTheLeastSquaresOptimum) {
  const Points source = test::random_points(10, 5);
  const Points target = test::random_rotation(6) * source + 0.2 * test::random_points(10, 7);
  const Eigen::VectorXd weights = Eigen::VectorXd::LinSpaced(10, 1, 5);
  const auto cost = [&](const RigidTransform& motion) {
    return (motion * source - target).colwise().squaredNorm().dot(weights);
  };
  const RigidTransform best = align_rigidly(source, target, weights);
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Points step = 1e-3 * test::random_points(2, seed);
    const RigidTransform nudge{Eigen::AngleAxisd(step.col(0).norm(), step.col(0).normalized()).matrix(),
                               step.col(1)};
    EXPECT_GT(cost(nudge * best), cost(best));
  }
}

TEST(AlignRigidly, FollowsInfiniteWeightsBeforeFiniteOnes) {
  const Points source = test::random_points(8, 8);
  const RigidTransform motion{test::random_rotation(9), Vector3(1, 0, 0)};
  Points target = motion * source;
  target.rightCols(4) += test::random_points(4, 10);
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(8, 1);
  weights.head(4).setConstant(infinity);
  EXPECT_LT((align_rigidly(source, target, weights).rotation - motion.rotation).norm(), 1e-5);
}

TEST(AlignRigidly, NamesWhatIsMissing) {
  const Points two = test::random_points(2, 1);
  EXPECT_THAT(refusal(two, two, equal_weights(2)), HasSubstr("there are 2"));
  EXPECT_THAT(refusal(Points(3, 0), Points(3, 0), equal_weights(0)), HasSubstr("there are 0"));
  Points line = test::random_points(5, 2);
  line = (Vector3(1, 2, 3) * line.row(0)).colwise() + Vector3(7, 8, 9);
  const Points spread = test::random_points(5, 3);
  EXPECT_THAT(refusal(line, spread, equal_weights(5)), HasSubstr("source are collinear"));
  EXPECT_THAT(refusal(spread, line, equal_weights(5)), HasSubstr("target are collinear"));
  EXPECT_THAT(refusal(Points::Ones(3, 5), spread, equal_weights(5)), HasSubstr("at one place"));
}

TEST(AlignRigidly, RefusesUnusableValues) {
  const Points points = test::random_points(4, 1);
  Points broken = points;
  broken(1, 2) = nan;
  EXPECT_THAT(refusal(broken, points, equal_weights(4)), HasSubstr("pair 2"));
  EXPECT_THAT(refusal(points, broken, equal_weights(4)), HasSubstr("pair 2"));
  EXPECT_THAT(refusal(points, points, Eigen::Vector4d(1, 0, 1, 1)), HasSubstr("weight"));
  EXPECT_THAT(refusal(points, points, Eigen::Vector4d(1, nan, 1, 1)), HasSubstr("weight"));
  EXPECT_THAT(refusal(points, points, equal_weights(3)), HasSubstr("must be equal"));
}

}  // namespace
}  // namespace bespoke
