#include "bespoke/surface_fit/matching/unmatched_cavities.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/pocketed_ball.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TriangleMesh ball_with_narrow_pocket() { return shapes::pocketed_ball(9 * std::numbers::pi / 180); }

std::vector<Cavity> unmatched(const TriangleMesh& source, const TriangleMesh& target) {
  return unmatched_cavities(cavities_of(source).parts, source, target, cavities_of(target).contains, {});
}

TEST(UnmatchedCavities, AreThoseOfASourceWhoseTargetIsSmooth) {
  const TriangleMesh source = ball_with_narrow_pocket();
  const std::vector<Cavity> found = unmatched(source, shapes::icosphere(4));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.front().vertices, cavities_of(source).parts.front().vertices);
}

TEST(UnmatchedCavities, AreNoneWhereTheTargetHasAPocketOfSomeSizeThere) {
  const TriangleMesh source = ball_with_narrow_pocket();
  const auto none = [&](const TriangleMesh& target) { return unmatched(source, target).empty(); };
  EXPECT_TRUE(none(source));
  EXPECT_TRUE(none(shapes::moved(source, {0.8 * Matrix3::Identity(), {0, 0, 0.1}})));
  EXPECT_FALSE(none(shapes::moved(source, {0.3 * Matrix3::Identity(), {0, 0, 0.6}})));
  // On the other side.
  EXPECT_FALSE(none(shapes::moved(source, {Vector3(1, -1, -1).asDiagonal().toDenseMatrix(), {0, 0, 0}})));
}

TEST(CarriedCavities, GoWithASpaceThatIsMappedAffinely) {
  const TriangleMesh source = ball_with_narrow_pocket();
  const Cavities cavities = cavities_of(source);
  Matrix3 stretch = Matrix3::Identity() + 0.3 * test::random_rotation(1);
  const AffineMap map{test::random_rotation(2) * stretch, {4, -7, 2}};
  const Points expected = map * source.vertices;
  Points fitted = expected;
  for (Eigen::Index i = 0; i < fitted.cols(); ++i)
    if (cavities.contains[static_cast<std::size_t>(i)]) fitted.col(i).setZero();
  const Points found = carried_by_space({source, fitted}, cavities.parts, cavities.contains, {});
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(CarriedCavities, StayUnderASkinThatIsThinner) {
  const TriangleMesh source = ball_with_narrow_pocket();
  const Cavities cavities = cavities_of(source);
  // Less than half as wide as the pocket in the middle of its height, which keeps its shape elsewhere.
  Points fitted = source.vertices;
  for (Eigen::Index i = 0; i < fitted.cols(); ++i)
    if (!cavities.contains[static_cast<std::size_t>(i)]) {
      const double height = fitted(2, i) - shapes::pocket_center(9 * std::numbers::pi / 180);
      fitted(0, i) *= 1 - 0.8 * std::exp(-height * height / 0.18);
    }
  const auto width = [&](const Points& points, bool is_cavity) {
    double most = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
      if ((cavities.contains[static_cast<std::size_t>(i)] != 0) == is_cavity &&
          std::abs(source.vertices(2, i) - shapes::pocket_center(9 * std::numbers::pi / 180)) < 0.1 &&
          std::abs(source.vertices(1, i)) < 0.1)
        most = std::max(most, std::abs(points(0, i)));
    return most;
  };
  ASSERT_GT(width(fitted, true), width(fitted, false));
  const Points found = carried_by_space({source, fitted}, cavities.parts, cavities.contains, {});
  EXPECT_LT(width(found, true), width(found, false));
}

TEST(CarriedCavities, AloneMove) {
  const TriangleMesh source = ball_with_narrow_pocket();
  const Cavities cavities = cavities_of(source);
  const Points fitted = source.vertices + 0.01 * test::random_points(source.vertices.cols(), 3);
  const Points found = carried_by_space({source, fitted}, cavities.parts, cavities.contains, {});
  for (Eigen::Index i = 0; i < fitted.cols(); ++i)
    if (!cavities.contains[static_cast<std::size_t>(i)]) {
      EXPECT_EQ(found.col(i), fitted.col(i));
    }
  EXPECT_EQ(carried_by_space({source, fitted}, {}, cavities.contains, {}), fitted);
}

}  // namespace
}  // namespace bespoke
