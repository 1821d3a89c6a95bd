#include "bespoke/rigid/affine_alignment.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

constexpr FlatDirections rules[] = {FlatDirections::of_squared_width_1e_12, FlatDirections::of_rounding};

const AffineMap skewed{Matrix3(Vector3(2, 0.5, 1.2).asDiagonal()) + 0.1 * Matrix3(test::random_points(3, 7)),
                       Vector3(4, -1, 7)};

TEST(AlignAffinely, RecoversTheMapOfPointsThatSpanSpace) {
  const Points x = test::random_points(20, 1);
  for (const FlatDirections rule : rules) {
    const AffineMap map = align_affinely(x, skewed * x, rule);
    EXPECT_LT((map.linear - skewed.linear).norm(), 1e-12);
    EXPECT_LT((map.offset - skewed.offset).norm(), 1e-12);
  }
}

// The normal equations: residuals are orthogonal to every affine function of the sources.
TEST(AlignAffinely, LeavesNoAffineResidual) {
  const Points x = test::random_points(30, 2);
  const Points y = skewed * x + 0.3 * test::random_points(30, 3);
  for (const FlatDirections rule : rules) {
    const Points residual = y - align_affinely(x, y, rule) * x;
    EXPECT_LT(residual.rowwise().sum().norm(), 1e-12);
    EXPECT_LT((residual * x.transpose()).norm(), 1e-12);
  }
}

TEST(AlignAffinely, IsTheIdentityAlongFlatDirections) {
  Points plane = test::random_points(20, 4);
  plane.row(2).setConstant(0.5);
  for (const FlatDirections rule : rules) {
    const AffineMap map = align_affinely(plane, 3 * plane, rule);
    EXPECT_LT((map.linear - Matrix3(Vector3(3, 3, 1).asDiagonal())).norm(), 1e-12);
    EXPECT_LT((map * plane - 3 * plane).norm(), 1e-12);
    const AffineMap moved = align_affinely(plane.col(0), plane.col(1), rule);
    EXPECT_EQ(moved.linear, Matrix3(Matrix3::Identity()));
  }
}

// Where the rules differ: a sheet thinner than a millionth of its width, but not by rounding alone.
TEST(AlignAffinely, TellsThinFromFlatByTheRule) {
  Points sheet = test::random_points(20, 5);
  sheet.row(2) *= 1e-7;
  const AffineMap stretched{Vector3(1, 1, 4).asDiagonal(), Vector3::Zero()};
  const auto thickness = [&](FlatDirections rule) {
    return align_affinely(sheet, stretched * sheet, rule).linear(2, 2);
  };
  EXPECT_NEAR(thickness(FlatDirections::of_squared_width_1e_12), 1, 1e-6);
  EXPECT_NEAR(thickness(FlatDirections::of_rounding), 4, 0.1);
}

TEST(AlignAffinely, RejectsUnequalOrNoPairs) {
  for (const FlatDirections rule : rules) {
    EXPECT_THROW(align_affinely(Points(3, 0), Points(3, 0), rule), InvalidInput);
    EXPECT_THROW(align_affinely(test::random_points(4, 1), test::random_points(5, 1), rule), InvalidInput);
  }
}

}  // namespace
}  // namespace bespoke
