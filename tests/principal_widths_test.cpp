#include "bespoke/principal_widths.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

namespace bespoke {
namespace {

Points on_axes(const Vector3& widths) {
  Points points(3, 6);
  points << Matrix3(widths.asDiagonal()), -Matrix3(widths.asDiagonal());
  return points;
}

// Two points at ±w along an axis are √2 w wide.
TEST(PrincipalWidths, AreThoseOfPointsOnTurnedAxesWhereverTheyLie) {
  const Matrix3 rotation = Eigen::AngleAxisd(0.8, Vector3(1, -2, 3).normalized()).toRotationMatrix();
  const Points points = (rotation * on_axes({1, 3, 2})).colwise() + Vector3(10, 20, -30);
  const PrincipalWidths found = principal_widths(points);
  EXPECT_TRUE(found.widths.isApprox(std::sqrt(2) * Vector3(3, 2, 1), 1e-12));
  const std::array<int, 3> axes = {1, 2, 0};
  for (int n = 0; n < 3; ++n)
    EXPECT_NEAR(std::abs(found.directions.col(n).dot(rotation.col(axes[static_cast<std::size_t>(n)]))), 1,
                1e-12);
}

// A sheet of a billionth of its width is told from a plane: the squares of widths would not tell it.
TEST(PrincipalWidths, TellASheetFromAPlane) {
  const Matrix3 rotation = Eigen::AngleAxisd(2, Vector3(3, 1, 2).normalized()).toRotationMatrix();
  const double thickness = 1e-9;
  const PrincipalWidths sheet = principal_widths(rotation * on_axes({1, 1, thickness}));
  EXPECT_NEAR(sheet.widths[2], std::sqrt(2) * thickness, 1e-3 * thickness);
  EXPECT_LT(principal_widths(rotation * on_axes({1, 1, 0})).widths[2], 1e-15);
}

TEST(PrincipalWidths, OfFewPointsAreZeroWhereTheyDoNotSpread) {
  EXPECT_EQ(principal_widths(Points(Vector3(1, 2, 3))).widths, Vector3(0, 0, 0));
  Points two(3, 2);
  two << Vector3(1, 2, 3), Vector3(1, 5, 7);
  const Vector3 widths = principal_widths(two).widths;
  EXPECT_NEAR(widths[0], 5 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(widths[1], 0, 1e-15);
}

}  // namespace
}  // namespace bespoke
