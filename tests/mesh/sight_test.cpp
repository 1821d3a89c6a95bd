#include "bespoke/mesh/sight.h"

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

TEST(Sight, IsBlockedWhereAWayMeetsABall) {
  const TriangleMesh ball = shapes::icosphere(4);
  const Sight sight(ball);
  const Points eyes = 3 * test::random_points(300, 1);
  const Points directions = test::random_points(300, 2).colwise().normalized();
  for (Eigen::Index i = 0; i < eyes.cols(); ++i) {
    const Vector3 x = eyes.col(i), direction = directions.col(i);
    const double before = -x.dot(direction), missed = (x + before * direction).norm();
    constexpr double facets = 0.01;  // what they leave of the radius
    if (std::abs(missed - 1) < facets || std::abs(x.norm() - 1) < facets) continue;
    const bool inside = x.norm() < 1;
    EXPECT_EQ(sight.is_blocked(x, direction), inside || (missed < 1 && before > 0)) << x.transpose();
    // From within only backs are seen.
    EXPECT_EQ(sight.is_blocked(x, direction, FaceSides::front), !inside && missed < 1 && before > 0);
  }
}

TEST(Sight, ReachesAsFarAsAsked) {
  const TriangleMesh sheet = shapes::square_grid(3);  // z = 0
  const Sight sight(sheet);
  const Vector3 above(0.4, 0.6, 0.5), down = -Vector3::UnitZ();
  EXPECT_TRUE(sight.is_blocked(above, down, FaceSides::front, 0.5001));
  EXPECT_FALSE(sight.is_blocked(above, down, FaceSides::front, 0.4999));
  EXPECT_FALSE(sight.is_blocked(above, -down));
  const Vector3 below(0.4, 0.6, -0.5);
  EXPECT_FALSE(sight.is_blocked(below, -down, FaceSides::front));
  EXPECT_TRUE(sight.is_blocked(below, -down, FaceSides::both));
}

TEST(Sight, GoesThroughNoEdgeAndNoCorner) {
  const TriangleMesh sheet = shapes::square_grid(4);
  const Sight sight(sheet);
  for (const double x : {0.25, 0.5, 0.75})
    for (const double y : {0.25, 0.375, 0.5}) EXPECT_TRUE(sight.is_blocked({x, y, 1}, -Vector3::UnitZ()));
}

TEST(Sight, DoesNotSeeWhatItLooksOutOf) {
  const TriangleMesh ball = shapes::icosphere(3);
  const Sight sight(ball);
  for (const auto& vertex : ball.vertices.colwise())
    EXPECT_FALSE(sight.is_blocked(vertex, vertex.normalized()));
}

TEST(EnclosedVertices, AreTheLiningOfAPocketWithANarrowMouth) {
  const TriangleMesh mesh = shapes::pocketed_ball(9 * std::numbers::pi / 180);
  const std::vector<char> enclosed = enclosed_vertices(mesh);
  for (std::size_t i = 0; i < enclosed.size(); ++i) {
    const Vector3 x = mesh.vertices.col(static_cast<Eigen::Index>(i));
    const bool at_the_mouth = x.z() > 0.85 && x.head<2>().norm() < 0.35;
    if (!at_the_mouth) {
      EXPECT_EQ(enclosed[i] != 0, shapes::in_pocket(x)) << x.transpose();
    }
  }
}

TEST(EnclosedVertices, AreTheSameInAnyPlaceAndSize) {
  const TriangleMesh mesh = shapes::pocketed_ball();
  const TriangleMesh moved = shapes::moved(mesh, {400 * test::random_rotation(3), Vector3(30, -500, 2)});
  const std::vector<char> here = enclosed_vertices(mesh), there = enclosed_vertices(moved);
  std::size_t differing = 0;
  for (std::size_t i = 0; i < here.size(); ++i) differing += here[i] != there[i];
  EXPECT_LE(differing, here.size() / 50);  // looks are not the same ones about another normal
}

TEST(EnclosedVertices, AreNoneOfASurfaceInTheOpenOrInsideOut) {
  TriangleMesh ball = shapes::icosphere(3);
  const auto none = [](const TriangleMesh& mesh) {
    const std::vector<char> enclosed = enclosed_vertices(mesh);
    return std::none_of(enclosed.begin(), enclosed.end(), [](char is) { return is != 0; });
  };
  EXPECT_TRUE(none(ball));
  ball.faces.row(1).swap(ball.faces.row(2));
  EXPECT_TRUE(none(ball));
  EXPECT_TRUE(none(shapes::square_grid(5)));
}

}  // namespace
}  // namespace bespoke
