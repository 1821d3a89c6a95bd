#include "bespoke/alignment/detail/similarity_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace bespoke {
namespace {

TEST(AxisRotations, AreTheRotationsOfTheCube) {
  const std::vector<Matrix3> rotations = axis_rotations();
  ASSERT_EQ(rotations.size(), 24u);
  for (const Matrix3& a : rotations) {
    EXPECT_NEAR(a.determinant(), 1, 1e-12);
    EXPECT_EQ(std::count(rotations.begin(), rotations.end(), a), 1);
  }
}

TEST(CoveringRotations, LeaveNoRotationFartherThan45Degrees) {
  const std::vector<Matrix3> rotations = covering_rotations();
  EXPECT_EQ(rotations.size(), 72u);  // 60 and 24, of which 12 are the tetrahedron's
  std::srand(7);
  for (int trial = 0; trial < 2000; ++trial) {
    const Matrix3 any = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
    double nearest = std::numbers::pi;
    for (const Matrix3& rotation : rotations)
      nearest = std::min(nearest, Eigen::AngleAxisd(Matrix3(rotation.transpose() * any)).angle());
    EXPECT_LE(nearest, std::numbers::pi / 4);
  }
}

}  // namespace
}  // namespace bespoke
