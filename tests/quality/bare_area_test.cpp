#include "bespoke/quality/bare_area.h"

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

TEST(BareArea, IsNoneWhereTheSourceLiesOnTheTarget) {
  const BareArea bare = bare_area(ball_at(Vector3::Zero()), ball_at(Vector3(0.01, 0, 0)), 0.02);
  EXPECT_EQ(bare.share, 0);
  EXPECT_EQ(bare.distance, 0);
  EXPECT_FALSE(bare.is_notable());
}

TEST(BareArea, IsTheShareOfTheTargetThatTheSourceIsFarFrom) {
  // Of radius 3/4 the smaller ball has 9/16 of the larger one's area, so 9/25 of both.
  const TriangleMesh here = ball_at(Vector3::Zero()),
                     two = shapes::joined(here, ball_at(Vector3(5, 0, 0), 0.75));
  const BareArea bare = bare_area(two, here, 0.1);
  EXPECT_NEAR(bare.share, 9.0 / 25, 1e-3);
  EXPECT_TRUE(bare.is_notable());
  EXPECT_NEAR(bare.distance, 4.75, 0.01);  // the farthest place of the smaller ball
  EXPECT_NEAR((bare.farthest - Vector3(5.75, 0, 0)).norm(), 0, 0.1);
  EXPECT_EQ(bare_area(here, two, 0.1).share, 0);
}

TEST(BareArea, IsNoneBeyondTheEndOfAnOpenSource) {
  const TriangleMesh square = shapes::square_grid(10);
  const TriangleMesh larger = shapes::moved(square, {3 * Matrix3::Identity(), Vector3(-1, -1, 0)});
  EXPECT_EQ(bare_area(larger, square, 0.05).share, 0);
  EXPECT_EQ(bare_area(shapes::moved(square, {Matrix3::Identity(), Vector3(0, 0, 0.1)}), square, 0.05).share,
            1);
}

TEST(BareArea, SaysWhereItIs) {
  BareArea bare;
  bare.share = 0.0291;
  bare.distance = 9.25;
  bare.farthest = Vector3(1, -2.5, 3);
  EXPECT_EQ(to_string(bare), "2.9 % of the target is bare, at most 9.25 from the source, at (1, -2.5, 3)");
}

TEST(BareArea, RefusesWhatIsNoReachAndNoMesh) {
  const TriangleMesh square = shapes::square_grid(2);
  EXPECT_THROW(bare_area(square, square, 0), InvalidInput);
  EXPECT_THROW(bare_area(square, square, std::nan("")), InvalidInput);
  EXPECT_THROW(bare_area(square, {square.vertices, Faces(3, 0)}, 1), InvalidInput);
  TriangleMesh broken = square;
  broken.vertices(0, 0) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(bare_area(square, broken, 1), InvalidInput);
}

}  // namespace
}  // namespace bespoke
