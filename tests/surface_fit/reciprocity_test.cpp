#include "bespoke/surface_fit/matching/reciprocity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace bespoke {
namespace {

const Vector3 centre(0.5, 0.5, 0);
const Vector3 upwards = Vector3::UnitZ();
const MatchLimits within_one{0.3, 1.0};
const ReciprocitySettings half_as_far;

/// The unit square at this height.
TriangleMesh plane_at(double height) {
  return shapes::moved(shapes::square_grid(4), {Matrix3::Identity(), height * upwards});
}

/// How much a point at height 1 above a square counts, beside what else its own surface has.
double reciprocity_beside(const TriangleMesh& other) {
  const TargetSurface from(shapes::joined(plane_at(1), other)), onto(plane_at(0));
  const Vector3 point = centre + upwards;
  const SurfaceMatch match = *onto.match(point, upwards, within_one);
  return reciprocity(back_distance_ratio({point, match, within_one}, from, 1, half_as_far), half_as_far);
}

TEST(Reciprocity, IsWholeBetweenParallelSurfaces) { EXPECT_EQ(reciprocity_beside(plane_at(1)), 1); }

TEST(Reciprocity, FallsAsAnotherPlaceComesNearer) {
  EXPECT_EQ(reciprocity_beside(plane_at(half_as_far.much_nearer * 1.01)), 1);
  double before = 1;
  for (const double share : {0.9, 0.5, 0.1}) {
    const double found = reciprocity_beside(plane_at(share * half_as_far.much_nearer));
    EXPECT_NEAR(found, std::pow(share, half_as_far.power), 1e-12);
    EXPECT_LT(found, before);
    before = found;
  }
  EXPECT_EQ(reciprocity_beside(plane_at(0)), 0);
}

TEST(Reciprocity, HeedsPlacesThatFaceAsTheMatchDoesOnly) {
  TriangleMesh back = plane_at(0.1);
  back.faces.row(0).swap(back.faces.row(1));
  EXPECT_EQ(reciprocity_beside(back), 1);
}

TEST(Reciprocity, HeedsNoBoundary) {
  // Nearest is the rim of a square that ends beside the match.
  EXPECT_EQ(reciprocity_beside(shapes::moved(plane_at(0.1), {Matrix3::Identity(), Vector3(0.6, 0, 0)})), 1);
}

TEST(Reciprocity, IsWholeOfAPointOnItsMatch) {
  const TargetSurface surface(plane_at(0));
  const SurfaceMatch match = *surface.match(centre, upwards, within_one);
  EXPECT_EQ(back_distance_ratio({centre, match, within_one}, surface, 1, half_as_far), 1);
  EXPECT_EQ(reciprocity(1, half_as_far), 1);
}

TEST(Reciprocity, NeedsNoReciprocityBeyondMuchNearer) {
  const TargetSurface onto(plane_at(0));
  const Vector3 point = centre + upwards;
  const SurfaceMatch match = *onto.match(point, upwards, within_one);
  for (const double height : {0.1, 0.4, 0.5, 0.6, 0.9}) {
    const TargetSurface from(shapes::joined(plane_at(1), plane_at(height)));
    const auto found = [&](double share) {
      return reciprocity(back_distance_ratio({point, match, within_one}, from, share, half_as_far),
                         half_as_far);
    };
    EXPECT_EQ(found(half_as_far.much_nearer), found(1)) << height;
  }
}

TEST(ReciprocalShare, IsThatOfTheNearestPlaceWithinTheShareAsked) {
  const TargetSurface from(shapes::joined(plane_at(1), plane_at(0.4))), onto(plane_at(0));
  const Vector3 point = centre + upwards;
  const SurfaceMatch match = *onto.match(point, upwards, within_one);
  const FoundPair pair{point, match, within_one};
  EXPECT_NEAR(back_distance_ratio(pair, from, 1, half_as_far), 0.4, 1e-12);
  EXPECT_NEAR(back_distance_ratio(pair, from, 0.5, half_as_far), 0.4, 1e-12);
  EXPECT_EQ(back_distance_ratio(pair, from, 0.3, half_as_far), 1);
}

TEST(NearerReciprocal, IsThePlaceThatIsNearerThanItsShare) {
  const TargetSurface from(shapes::joined(plane_at(1), plane_at(0.4))), onto(plane_at(0));
  const Vector3 point = centre + upwards;
  const SurfaceMatch match = *onto.match(point, upwards, within_one);
  const auto back = back_match({point, match, within_one}, from, 0.5);
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->point.isApprox(centre + 0.4 * upwards, 1e-12));
  EXPECT_FALSE(back_match({point, match, within_one}, from, 0.3));
}

}  // namespace
}  // namespace bespoke
