#include "bespoke/surface_fit/detail/lacking_linings.h"

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

std::vector<Lining> lacking(const TriangleMesh& source, const TriangleMesh& target) {
  return lacking_linings(linings_of(source).parts, source, target, linings_of(target).contains, {});
}

TEST(LackingLinings, AreThoseOfASourceWhoseTargetIsSmooth) {
  const TriangleMesh source = ball_with_narrow_pocket();
  const std::vector<Lining> found = lacking(source, shapes::icosphere(4));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.front().vertices, linings_of(source).parts.front().vertices);
}

TEST(LackingLinings, AreNoneWhereTheTargetHasAPocketOfSomeSizeThere) {
  const TriangleMesh source = ball_with_narrow_pocket();
  const auto none = [&](const TriangleMesh& target) { return lacking(source, target).empty(); };
  EXPECT_TRUE(none(source));
  EXPECT_TRUE(none(shapes::moved(source, {0.8 * Matrix3::Identity(), {0, 0, 0.1}})));
  EXPECT_FALSE(none(shapes::moved(source, {0.3 * Matrix3::Identity(), {0, 0, 0.6}})));
  // On the other side.
  EXPECT_FALSE(none(shapes::moved(source, {Vector3(1, -1, -1).asDiagonal().toDenseMatrix(), {0, 0, 0}})));
}

TEST(CarriedLinings, GoWithASpaceThatIsMappedAffinely) {
  const TriangleMesh source = ball_with_narrow_pocket();
  const Linings linings = linings_of(source);
  Matrix3 stretch = Matrix3::Identity() + 0.3 * test::random_rotation(1);
  const AffineMap map{test::random_rotation(2) * stretch, {4, -7, 2}};
  const Points expected = map * source.vertices;
  Points fitted = expected;
  for (Eigen::Index i = 0; i < fitted.cols(); ++i)
    if (linings.contains[static_cast<std::size_t>(i)]) fitted.col(i).setZero();
  const Points found = carried_by_space({source, fitted}, linings.parts, linings.contains, {});
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(CarriedLinings, StayUnderASkinThatIsThinner) {
  const TriangleMesh source = ball_with_narrow_pocket();
  const Linings linings = linings_of(source);
  // Less than half as wide as the pocket in the middle of its height, which keeps its shape elsewhere.
  Points fitted = source.vertices;
  for (Eigen::Index i = 0; i < fitted.cols(); ++i)
    if (!linings.contains[static_cast<std::size_t>(i)]) {
      const double height = fitted(2, i) - shapes::pocket_center(9 * std::numbers::pi / 180);
      fitted(0, i) *= 1 - 0.8 * std::exp(-height * height / 0.18);
    }
  const auto width = [&](const Points& points, bool is_lining) {
    double most = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
      if ((linings.contains[static_cast<std::size_t>(i)] != 0) == is_lining &&
          std::abs(source.vertices(2, i) - shapes::pocket_center(9 * std::numbers::pi / 180)) < 0.1 &&
          std::abs(source.vertices(1, i)) < 0.1)
        most = std::max(most, std::abs(points(0, i)));
    return most;
  };
  ASSERT_GT(width(fitted, true), width(fitted, false));
  const Points found = carried_by_space({source, fitted}, linings.parts, linings.contains, {});
  EXPECT_LT(width(found, true), width(found, false));
}

TEST(CarriedLinings, AloneMove) {
  const TriangleMesh source = ball_with_narrow_pocket();
  const Linings linings = linings_of(source);
  const Points fitted = source.vertices + 0.01 * test::random_points(source.vertices.cols(), 3);
  const Points found = carried_by_space({source, fitted}, linings.parts, linings.contains, {});
  for (Eigen::Index i = 0; i < fitted.cols(); ++i)
    if (!linings.contains[static_cast<std::size_t>(i)]) {
      EXPECT_EQ(found.col(i), fitted.col(i));
    }
  EXPECT_EQ(carried_by_space({source, fitted}, {}, linings.contains, {}), fitted);
}

}  // namespace
}  // namespace bespoke
