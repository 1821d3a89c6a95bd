#include "bespoke/mesh/visibility.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(VisibilityQuery, IsBlockedWhereAWayMeetsABall) {
  const TriangleMesh ball = shapes::icosphere(4);
  const VisibilityQuery visibility(ball);
  const Points eyes = 3 * test::random_points(300, 1);
  const Points directions = test::random_points(300, 2).colwise().normalized();
  for (Eigen::Index i = 0; i < eyes.cols(); ++i) {
    const Vector3 x = eyes.col(i), direction = directions.col(i);
    const double before = -x.dot(direction), missed = (x + before * direction).norm();
    constexpr double facets = 0.01;  // what they leave of the radius
    if (std::abs(missed - 1) < facets || std::abs(x.norm() - 1) < facets) continue;
    const bool inside = x.norm() < 1;
    EXPECT_EQ(visibility.is_blocked(x, direction), inside || (missed < 1 && before > 0)) << x.transpose();
    // From within only backs are seen.
    EXPECT_EQ(visibility.is_blocked(x, direction, FaceSides::front), !inside && missed < 1 && before > 0);
  }
}

TEST(VisibilityQuery, ReachesAsFarAsAsked) {
  const TriangleMesh sheet = shapes::square_grid(3);  // z = 0
  const VisibilityQuery visibility(sheet);
  const Vector3 above(0.4, 0.6, 0.5), down = -Vector3::UnitZ();
  EXPECT_TRUE(visibility.is_blocked(above, down, FaceSides::front, 0.5001));
  EXPECT_FALSE(visibility.is_blocked(above, down, FaceSides::front, 0.4999));
  EXPECT_FALSE(visibility.is_blocked(above, -down));
  const Vector3 below(0.4, 0.6, -0.5);
  EXPECT_FALSE(visibility.is_blocked(below, -down, FaceSides::front));
  EXPECT_TRUE(visibility.is_blocked(below, -down, FaceSides::both));
}

TEST(VisibilityQuery, GoesThroughNoEdgeAndNoCorner) {
  const TriangleMesh sheet = shapes::square_grid(4);
  const VisibilityQuery visibility(sheet);
  for (const double x : {0.25, 0.5, 0.75})
    for (const double y : {0.25, 0.375, 0.5})
      EXPECT_TRUE(visibility.is_blocked({x, y, 1}, -Vector3::UnitZ()));
}

TEST(VisibilityQuery, DoesNotSeeWhatItLooksOutOf) {
  const TriangleMesh ball = shapes::icosphere(3);
  const VisibilityQuery visibility(ball);
  for (const auto& vertex : ball.vertices.colwise())
    EXPECT_FALSE(visibility.is_blocked(vertex, vertex.normalized()));
}

}  // namespace
}  // namespace bespoke
