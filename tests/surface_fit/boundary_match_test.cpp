#include "bespoke/surface_fit/matching/boundary_match.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace bespoke {
namespace {

TriangleMesh square_from(double left) {
  TriangleMesh square = shapes::square_grid(10);
  square.vertices.row(0) = (left + (1 - left) * square.vertices.row(0).array()).matrix();
  return square;
}

TEST(BoundaryMatcher, TakesNearbyCutsForTheSame) {
  const TargetSurface target(square_from(0.1));
  const TriangleMesh source = shapes::square_grid(8);
  BoundaryMatcher matcher({TargetSurface(source), Vector3(0.5, 0.5, 0), target, BoundaryRule::automatic});
  EXPECT_EQ(matcher.boundaries(), 1);
  EXPECT_TRUE(matcher.match(source.vertices).empty());  // before the decision
  matcher.decide(source.vertices);
  EXPECT_EQ(matcher.matched_boundaries(), 1);
  const auto matches = matcher.match(source.vertices);
  EXPECT_EQ(matches.size(), 32u);
  double length = 0;
  for (const BoundaryMatch& match : matches) {
    length += match.length;
    EXPECT_NEAR(match.tangent.norm(), 1, 1e-12);
    const Vector3 x = source.vertices.col(match.vertex);
    EXPECT_LE((match.point - x).norm(), 0.1 + 1e-12);
    EXPECT_TRUE(std::abs(match.point[0] - 0.1) < 1e-12 || std::abs(match.point[0] - 1) < 1e-12 ||
                std::abs(match.point[1]) < 1e-12 || std::abs(match.point[1] - 1) < 1e-12);
  }
  EXPECT_NEAR(length, 4, 1e-12);
}

TEST(BoundaryMatcher, LeavesACutThatWouldStretchTheSourceByHalf) {
  const TargetSurface target(square_from(0.45));
  const TriangleMesh source = shapes::square_grid(8);
  BoundaryMatcher matcher({TargetSurface(source), Vector3(0.5, 0.5, 0), target, BoundaryRule::automatic});
  matcher.decide(source.vertices);
  EXPECT_EQ(matcher.matched_boundaries(), 0);
  EXPECT_TRUE(matcher.match(source.vertices).empty());
}

TEST(BoundaryMatcher, ObeysTheCaller) {
  const TargetSurface near(square_from(0.1)), far(square_from(0.45));
  const TriangleMesh source = shapes::square_grid(8);
  BoundaryMatcher free({TargetSurface(source), Vector3(0.5, 0.5, 0), near, BoundaryRule::free});
  free.decide(source.vertices);
  EXPECT_TRUE(free.match(source.vertices).empty());
  for (const Points& anchors : {Points(Vector3(0.5, 0.5, 0)), Points(3, 0)}) {
    BoundaryMatcher matched({TargetSurface(source), anchors, far, BoundaryRule::matched});
    matched.decide(source.vertices);
    EXPECT_EQ(matched.matched_boundaries(), 1);
    EXPECT_EQ(matched.match(source.vertices).size(), 32u);
  }
}

TEST(BoundaryMatcher, HasNothingToDoOnClosedModels) {
  const TargetSurface closed(shapes::cube()), open(shapes::square_grid(4));
  EXPECT_EQ(BoundaryMatcher({open, Vector3::Zero(), closed, BoundaryRule::matched}).boundaries(), 0);
  EXPECT_EQ(BoundaryMatcher({closed, Vector3::Zero(), open, BoundaryRule::matched}).boundaries(), 0);
}

}  // namespace
}  // namespace bespoke
