#include "bespoke/alignment/detail/soft_matches.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace bespoke {
namespace {

const SurfacePatches& ball() {
  static const SurfacePatches patches = make_surface_patches(shapes::icosphere(3), 150);
  return patches;
}

TEST(SoftMatches, OfASurfaceWithItselfAreItsPatches) {
  const SoftMatches matches =
      soft_matches(ball(), ball().points, ball().normals, ball(), 0.3 * ball().spacing);
  EXPECT_GT(matches.matched(), 0.95);
  EXPECT_LT(matches.residual(ball().points), 0.1 * ball().spacing);
}

TEST(SoftMatches, FindNothingFarAway) {
  const Points far = ball().points.colwise() + Vector3(10, 0, 0);
  const SoftMatches matches = soft_matches(ball(), far, ball().normals, ball(), 0.3);
  EXPECT_LT(matches.matched(), 1e-9);
}

TEST(SoftMatches, FindNothingThatFacesTheOtherWay) {
  const double length = 0.3 * ball().spacing;
  const SoftMatches matches = soft_matches(ball(), ball().points, -ball().normals, ball(), length);
  EXPECT_LT(matches.matched(), 0.1);
}

TEST(SoftMatches, LeaveTheExcessOfALargerSurfaceAlone) {
  TriangleMesh whole = shapes::square_grid(20), half = whole;
  half.vertices.row(0) /= 2;
  const SurfacePatches small = make_surface_patches(half, 50), large = make_surface_patches(whole, 100);
  const SoftMatches matches = soft_matches(small, small.points, small.normals, large, 0.5 * large.spacing);
  EXPECT_GT(matches.matched(), 0.6);
  EXPECT_LT(matches.matched(), 0.9);
  EXPECT_LT((matches.targets - small.points).colwise().norm().mean(), 0.5 * large.spacing);
}

}  // namespace
}  // namespace bespoke
