#include "bespoke/flow/regional_motion.h"

#include <gtest/gtest.h>

#include <numbers>

#include "flow/bent_tube.h"
#include "support/arithmetic.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::degree;

TEST(RegionalMotion, OfALimbIsItsTurn) {
  const TriangleMesh source = test::tube();
  for (const double angle : {30.0, 90.0, 150.0}) {
    const RegionalMotion motion = regional_motion(source, test::bent(source.vertices, angle * degree));
    EXPECT_NEAR(motion.turn, angle * degree, 1 * degree);
  }
}

// A whole that grows needs no steps for it: an affine part does that exactly.
TEST(RegionalMotion, OfASimilarityIsItsTurn) {
  const TriangleMesh source = shapes::icosphere(3);
  const Matrix3 turn = Eigen::AngleAxisd(0.7, Vector3::UnitX()).toRotationMatrix();
  const RegionalMotion motion = regional_motion(source, 0.25 * turn * source.vertices);
  EXPECT_NEAR(motion.turn, 0.7, 1e-9);
  EXPECT_NEAR(motion.stretch, 1, 1e-9);
}

TEST(RegionalMotion, StretchesAgainstTheWhole) {
  const TriangleMesh source = shapes::icosphere(3);
  Points fitted = source.vertices;
  for (auto x : fitted.colwise())
    if (x[2] > 0) x[2] *= 3;
  const double stretch = regional_motion(source, fitted).stretch;
  EXPECT_GT(stretch, 1.2);
  EXPECT_LT(stretch, 3);
  EXPECT_NEAR(regional_motion(source, 8 * fitted).stretch, stretch, 1e-9);
}

TEST(RegionalMotion, DoesNotBelieveOneBadFace) {
  const TriangleMesh source = shapes::icosphere(5);
  Points fitted = source.vertices;
  fitted.col(100) *= 0.9;  // its faces tilt by some 60°
  const RegionalMotion motion = regional_motion(source, fitted);
  EXPECT_LT(motion.turn, 10 * degree);
  EXPECT_EQ(step_count(motion), 1);
}

TEST(StepCount, IsOneForOnePoseAndGrowsWithTheTurn) {
  EXPECT_EQ(step_count({0, 1}), 1);
  EXPECT_EQ(step_count({45 * degree, 2.4}), 1);
  EXPECT_EQ(step_count({81 * degree, 1.3}), 3);
  EXPECT_EQ(step_count({99 * degree, 2.2}), 4);
  EXPECT_EQ(step_count({270 * degree, 1}), 9);
  EXPECT_GT(step_count({0, 5}), 1);
}

}  // namespace
}  // namespace bespoke
