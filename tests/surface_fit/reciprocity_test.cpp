#include "bespoke/surface_fit/detail/reciprocity.h"

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

/// How much a point at height 1 above the answering square counts, beside what else the asking surface has.
double reciprocity_beside(const TriangleMesh& other) {
  const TargetSurface asking(shapes::joined(plane_at(1), other)), answering(plane_at(0));
  const Vector3 point = centre + upwards;
  const SurfaceMatch match = *answering.match(point, upwards, within_one);
  return reciprocity(claimed_share({point, match, within_one}, asking, 1, half_as_far), half_as_far);
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
  EXPECT_EQ(claimed_share({centre, match, within_one}, surface, 1, half_as_far), 1);
  EXPECT_EQ(reciprocity(1, half_as_far), 1);
}

TEST(Reciprocity, NeedsNoReciprocityBeyondMuchNearer) {
  const TargetSurface answering(plane_at(0));
  const Vector3 point = centre + upwards;
  const SurfaceMatch match = *answering.match(point, upwards, within_one);
  for (const double height : {0.1, 0.4, 0.5, 0.6, 0.9}) {
    const TargetSurface asking(shapes::joined(plane_at(1), plane_at(height)));
    const auto found = [&](double share) {
      return reciprocity(claimed_share({point, match, within_one}, asking, share, half_as_far), half_as_far);
    };
    EXPECT_EQ(found(half_as_far.much_nearer), found(1)) << height;
  }
}

TEST(ReciprocalShare, IsThatOfTheNearestPlaceWithinTheShareAsked) {
  const TargetSurface asking(shapes::joined(plane_at(1), plane_at(0.4))), answering(plane_at(0));
  const Vector3 point = centre + upwards;
  const SurfaceMatch match = *answering.match(point, upwards, within_one);
  const FoundPair pair{point, match, within_one};
  EXPECT_NEAR(claimed_share(pair, asking, 1, half_as_far), 0.4, 1e-12);
  EXPECT_NEAR(claimed_share(pair, asking, 0.5, half_as_far), 0.4, 1e-12);
  EXPECT_EQ(claimed_share(pair, asking, 0.3, half_as_far), 1);
}

TEST(NearerReciprocal, IsThePlaceThatIsNearerThanItsShare) {
  const TargetSurface asking(shapes::joined(plane_at(1), plane_at(0.4))), answering(plane_at(0));
  const Vector3 point = centre + upwards;
  const SurfaceMatch match = *answering.match(point, upwards, within_one);
  const auto claim = nearer_claim({point, match, within_one}, asking, 0.5);
  ASSERT_TRUE(claim);
  EXPECT_TRUE(claim->point.isApprox(centre + 0.4 * upwards, 1e-12));
  EXPECT_FALSE(nearer_claim({point, match, within_one}, asking, 0.3));
}

}  // namespace
}  // namespace bespoke
