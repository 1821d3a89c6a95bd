#include "bespoke/quality/self_intersection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "bespoke/error.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

AffineMap shift(double x, double y, double z) { return {Matrix3::Identity(), {x, y, z}}; }

TriangleMesh pair_of_triangles(const Points& second) {
  TriangleMesh other = shapes::triangle();
  other.vertices = second;
  return shapes::joined(shapes::triangle(), other);
}

TEST(SelfIntersections, AreNoneOfAnEmbeddedSurface) {
  EXPECT_THAT(self_intersections(shapes::icosphere(3)), IsEmpty());
  EXPECT_THAT(self_intersections(shapes::cube()), IsEmpty());
  EXPECT_THAT(self_intersections(shapes::square_grid(10)), IsEmpty());
}

TEST(SelfIntersections, AreFacesThatPassThroughEachOther) {
  // An edge of the second through the first, and the other way round.
  EXPECT_THAT(self_intersections(pair_of_triangles(Points{{0.2, 0.2, 5}, {0.2, 0.2, 5}, {-1, 1, 0}})),
              ElementsAre(Pair(0, 1)));
  EXPECT_THAT(self_intersections(pair_of_triangles(Points{{0.5, 0.5, 0.5}, {-9, 9, 0}, {-9, -9, 9}})),
              ElementsAre(Pair(0, 1)));
  EXPECT_THAT(self_intersections(pair_of_triangles(Points{{2.2, 2.2, 5}, {0.2, 0.2, 5}, {-1, 1, 0}})),
              IsEmpty());
}

TEST(SelfIntersections, AreNoneOfFacesThatTouchOrOverlapInAPlane) {
  EXPECT_THAT(self_intersections(pair_of_triangles(Points{{0.2, 0.2, 5}, {0.2, 0.2, 5}, {0, 1, 1}})),
              IsEmpty());
  EXPECT_THAT(self_intersections(pair_of_triangles(Points{{0.1, 0.8, 0.1}, {0.1, 0.1, 0.8}, {0, 0, 0}})),
              IsEmpty());
  EXPECT_THAT(self_intersections(shapes::joined(shapes::icosphere(1), shapes::icosphere(1))), IsEmpty());
}

TEST(SelfIntersections, AreNoneOfNeighbours) {
  TriangleMesh folded = pair_of_triangles(Points{{0, 1, 0.3}, {0, 0, 0.3}, {0, 0, 0.5}});
  EXPECT_THAT(self_intersections(folded), IsEmpty());
}

TEST(SelfIntersections, OfCrossingSpheresDoNotDependOnTheirPlaceOrSize) {
  const TriangleMesh spheres =
      shapes::joined(shapes::icosphere(3), shapes::moved(shapes::icosphere(3), shift(0.81, 0.37, 0.23)));
  const auto pairs = self_intersections(spheres);
  EXPECT_GT(pairs.size(), 50u);
  EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
  for (const auto& [a, b] : pairs) {
    EXPECT_LT(a, 1280);
    EXPECT_GE(b, 1280);
  }
  for (const double scale : {1e-6, 1.0, 1e6})
    EXPECT_EQ(self_intersections(
                  shapes::moved(spheres, {scale * test::random_rotation(3), scale * Vector3(5, 6, 7)})),
              pairs);
}

TEST(SelfIntersections, OfACrossingGridsAreCountedExactly) {
  // A vertical strip x = 0.51, y from −1 to 2, through an n×n grid meets the 2n faces of one column of
  // squares; each of its two triangles meets those that its half covers.
  TriangleMesh strip;
  strip.vertices = Points{{0.51, 0.51, 0.51}, {-9, 9, 0.5}, {-1, -1, 9}};
  strip.faces = Faces{{0}, {1}, {2}};
  EXPECT_EQ(self_intersections(shapes::joined(shapes::square_grid(10), strip)).size(), 20u);
}

TEST(SelfIntersections, OfSomeFacesAreThoseWithOneOfThem) {
  const TriangleMesh spheres =
      shapes::joined(shapes::icosphere(3), shapes::moved(shapes::icosphere(3), shift(0.81, 0.37, 0.23)));
  const auto all = self_intersections(spheres);
  std::vector<char> some(static_cast<std::size_t>(spheres.faces.cols()), 0);
  for (std::size_t face = 0; face < some.size(); face += 3) some[face] = 1;
  auto expected = all;
  std::erase_if(expected, [&](const auto& pair) {
    return !some[static_cast<std::size_t>(pair.first)] && !some[static_cast<std::size_t>(pair.second)];
  });
  EXPECT_GT(expected.size(), 20u);
  EXPECT_EQ(intersections_of(spheres, some), expected);
  EXPECT_THAT(intersections_of(spheres, std::vector<char>(some.size(), 0)), IsEmpty());
  auto with_others = expected;
  with_others.emplace_back(0, 1);
  EXPECT_EQ(intersecting(spheres, with_others), expected);
}

TEST(SelfIntersections, RefuseAnInvalidMesh) { EXPECT_THROW(self_intersections({}), InvalidInput); }

}  // namespace
}  // namespace bespoke
