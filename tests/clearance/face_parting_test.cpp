#include "bespoke/clearance/detail/face_parting.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace bespoke {
namespace {

Matrix3 face(const Vector3& a, const Vector3& b, const Vector3& c) {
  Matrix3 corners;
  corners << a, b, c;
  return corners;
}

const Matrix3 floor = face({-1, -1, 0}, {1, -1, 0}, {0, 1, 0});

// Along the normal of the first by 0.1, along its own by the extent of the first: the first is the least.
TEST(Parting, IsTheLeastPushToTheSideOfBefore) {
  const Matrix3 above = face({0, 0, 0.2}, {0.3, 0, 0.5}, {0, 0.3, 0.5});
  Matrix3 sunk = above;
  sunk.row(2).array() -= 0.3;
  const auto found = parting(floor, above, floor, sunk);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->overlap, 0.1, 1e-12);
  EXPECT_NEAR(found->axis.z(), 1, 1e-12);
  Matrix3 parted = sunk;
  parted.colwise() += (found->overlap + 0.01) * found->axis;
  EXPECT_GT((found->axis.transpose() * parted).minCoeff(), (found->axis.transpose() * floor).maxCoeff());
}

TEST(Parting, TurnsWithTheFaces) {
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(2, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  const Matrix3 above = face({0, 0, 0.2}, {0.3, 0, 0.5}, {0, 0.3, 0.5});
  Matrix3 sunk = above;
  sunk.row(2).array() -= 0.3;
  const auto found = parting(floor, above, turned * floor, turned * sunk);
  ASSERT_TRUE(found);
  EXPECT_LT((found->axis - turned * Vector3::UnitZ()).norm(), 1e-12);
}

TEST(Parting, IsNegativeWhereTheyAreApartAndNoneWhereTheyNeverWere) {
  const Matrix3 above = face({0, 0, 0.2}, {0.3, 0, 0.5}, {0, 0.3, 0.5});
  EXPECT_LT(parting(floor, above, floor, above)->overlap, 0);
  Matrix3 through = above;
  through.row(2).array() -= 0.3;
  EXPECT_FALSE(parting(floor, through, floor, through));
}

}  // namespace
}  // namespace bespoke
