#include "bespoke/quality/uncovered_area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TriangleMesh ball_at(const Vector3& place, double radius = 1) {
  return shapes::moved(shapes::icosphere(4), {radius * Matrix3::Identity(), place});
}

TEST(UncoveredArea, IsNoneWhereTheSourceLiesOnTheTarget) {
  const UncoveredArea uncovered =
      uncovered_area(ball_at(Vector3::Zero()), ball_at(Vector3(0.01, 0, 0)), 0.02);
  EXPECT_EQ(uncovered.share, 0);
  EXPECT_EQ(uncovered.distance, 0);
  EXPECT_FALSE(uncovered.is_notable());
}

TEST(UncoveredArea, IsTheShareOfTheTargetThatTheSourceIsFarFrom) {
  // Of radius 3/4 the smaller ball has 9/16 of the larger one's area, so 9/25 of both.
  const TriangleMesh here = ball_at(Vector3::Zero()),
                     two = shapes::joined(here, ball_at(Vector3(5, 0, 0), 0.75));
  const UncoveredArea uncovered = uncovered_area(two, here, 0.1);
  EXPECT_NEAR(uncovered.share, 9.0 / 25, 1e-3);
  EXPECT_TRUE(uncovered.is_notable());
  EXPECT_NEAR(uncovered.distance, 4.75, 0.01);  // the farthest place of the smaller ball
  EXPECT_NEAR((uncovered.farthest - Vector3(5.75, 0, 0)).norm(), 0, 0.1);
  EXPECT_EQ(uncovered_area(here, two, 0.1).share, 0);
}

TEST(UncoveredArea, IsNoneBeyondTheEndOfAnOpenSource) {
  const TriangleMesh square = shapes::square_grid(10);
  const TriangleMesh larger = shapes::moved(square, {3 * Matrix3::Identity(), Vector3(-1, -1, 0)});
  EXPECT_EQ(uncovered_area(larger, square, 0.05).share, 0);
  EXPECT_EQ(
      uncovered_area(shapes::moved(square, {Matrix3::Identity(), Vector3(0, 0, 0.1)}), square, 0.05).share,
      1);
}

TEST(UncoveredArea, SaysWhereItIs) {
  UncoveredArea uncovered;
  uncovered.share = 0.0291;
  uncovered.distance = 9.25;
  uncovered.farthest = Vector3(1, -2.5, 3);
  EXPECT_EQ(to_string(uncovered),
            "2.9 % of the target is uncovered, at most 9.25 from the source, at (1, -2.5, 3)");
}

TEST(UncoveredArea, RefusesWhatIsNoReachAndNoMesh) {
  const TriangleMesh square = shapes::square_grid(2);
  EXPECT_THROW(uncovered_area(square, square, 0), InvalidInput);
  EXPECT_THROW(uncovered_area(square, square, std::nan("")), InvalidInput);
  EXPECT_THROW(uncovered_area(square, {square.vertices, Faces(3, 0)}, 1), InvalidInput);
  TriangleMesh broken = square;
  broken.vertices(0, 0) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(uncovered_area(square, broken, 1), InvalidInput);
}

}  // namespace
}  // namespace bespoke
