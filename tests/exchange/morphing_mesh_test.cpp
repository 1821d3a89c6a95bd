#include "bespoke/exchange/morphing_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bespoke/error.h"
#include "exchange/turning_product.h"

namespace bespoke {
namespace {

using test::half_turn;
using test::IdentityMap;
using test::two_polygons;

TEST(MorphAlong, ReachesTheMapAtTheLastTarget) {
  const MorphingMesh mesh = morph_along(two_polygons(), IdentityMap(), half_turn(), 3);
  ASSERT_EQ(mesh.targets.size(), 3u);
  EXPECT_EQ(mesh.product.vertices, two_polygons().vertices);
  EXPECT_LT((mesh.targets.back() - half_turn() * two_polygons().vertices).norm(), 1e-12);
}

// A point at distance r of the axis runs along a chord of the angle θ / n, whose middle is r (1 - cos(θ /
// 2n)) inside.
TEST(MorphAlong, SaysHowFarChordsOfATurnAreOffItsCircle) {
  const Points vertices = two_polygons().vertices;
  const double radius = std::hypot(9.0, 9.0);
  for (const int targets : {1, 2, 7}) {
    const MorphingMesh mesh = morph_along(two_polygons(), IdentityMap(), half_turn(), targets);
    EXPECT_NEAR(mesh.off_path, radius * (1 - std::cos(std::numbers::pi / (2 * targets))), 1e-12);
  }
}

TEST(MorphAlong, IsOnThePathOfAShift) {
  const RigidTransform shift{Matrix3::Identity(), Vector3(1, 2, 3)};
  EXPECT_LT(morph_along(two_polygons(), IdentityMap(), shift, 1).off_path, 1e-14);
}

TEST(MorphAlong, RefusesNoTargetsAndNoFaces) {
  EXPECT_THROW(morph_along(two_polygons(), IdentityMap(), half_turn(), 0), InvalidInput);
  Product points;
  points.vertices = Points::Identity(3, 3);
  EXPECT_THROW(morph_along(points, IdentityMap(), half_turn(), 1), InvalidInput);
}

}  // namespace
}  // namespace bespoke
