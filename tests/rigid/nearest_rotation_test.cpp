#include "bespoke/rigid/nearest_rotation.h"

#include <gtest/gtest.h>

#include "support/random_points.h"

namespace bespoke {
namespace {

TEST(NearestRotation, OfAStretchedRotationIsTheRotation) {
  const Matrix3 rotation = test::random_rotation(4), axes = test::random_rotation(5);
  const Matrix3 stretch = axes * Vector3(0.5, 1, 3).asDiagonal() * axes.transpose();
  const NearestRotation nearest = nearest_rotation(rotation * stretch);
  EXPECT_TRUE(nearest.rotation.isApprox(rotation, 1e-13));
  EXPECT_NEAR(nearest.trace, 4.5, 1e-13);
}

TEST(NearestRotation, IsNeverAReflection) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Matrix3 matrix = test::random_points(3, seed);
    if (matrix.determinant() > 0) matrix.col(0) *= -1;
    const NearestRotation nearest = nearest_rotation(matrix);
    EXPECT_NEAR(nearest.rotation.determinant(), 1, 1e-13);
    EXPECT_TRUE((nearest.rotation * nearest.rotation.transpose()).isIdentity(1e-13));
    EXPECT_NEAR(nearest.trace, (nearest.rotation.transpose() * matrix).trace(), 1e-13);
  }
}

TEST(NearestRotation, IsNearerThanAnyOther) {
  const Matrix3 matrix = test::random_points(3, 7);
  const double least = (nearest_rotation(matrix).rotation - matrix).norm();
  for (unsigned seed = 0; seed < 1000; ++seed)
    EXPECT_LE(least, (test::random_rotation(seed) - matrix).norm());
}

}  // namespace
}  // namespace bespoke
