#include "bespoke/surface_fit/matching/crease.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr double pi = std::numbers::pi;
const Vector3 outside = Vector3::UnitZ();
const MatchLimits anywhere{0.3, 1.0};

/// A valley along y, through the origin, whose walls are 2α apart about the z axis and face outside.
TriangleMesh valley(double alpha) {
  TriangleMesh mesh;
  const double x = 9 * std::sin(alpha), z = 9 * std::cos(alpha);
  mesh.vertices.resize(3, 6);
  mesh.vertices << 0, 0, x, x, -x, -x, -9, 9, -9, 9, -9, 9, 0, 0, z, z, z, z;
  mesh.faces.resize(3, 4);
  mesh.faces << 0, 2, 4, 0, 2, 3, 0, 1, 1, 1, 1, 5;
  return mesh;
}

/// Of the bottom of the valley, with a match at this height on a plane.
double crease_of(double alpha, double height) {
  const TargetSurface from(valley(alpha));
  const TargetSurface onto(
      shapes::moved(shapes::square_grid(4), {2 * Matrix3::Identity(), Vector3(-1, -1, height)}));
  const SurfaceMatch match = *onto.match(Vector3::Zero(), outside, anywhere);
  const FoundPair pair{Vector3::Zero(), match, anywhere};
  return crease(pair, back_distance_ratio(pair, from, 1, {}));
}

TEST(Crease, IsTheFourthPowerOfTheCosineOfHalfAWedge) {
  for (const double alpha : {pi / 6, pi / 4, pi / 3, 0.45 * pi})
    for (const double height : {0.1, 0.5})
      EXPECT_NEAR(crease_of(alpha, height), std::pow(std::cos(alpha), 4), 1e-12);
}

TEST(Crease, IsNoneWhereTheSurfaceIsFlat) { EXPECT_NEAR(crease_of(pi / 2, 0.5), 0, 1e-12); }

TEST(Crease, IsNoneOfARidge) { EXPECT_NEAR(crease_of(0.7 * pi, 0.5), 0, 1e-12); }

TEST(Crease, IsNoneWhereTheMatchIsBehind) { EXPECT_EQ(crease_of(pi / 4, -0.5), 0); }

TEST(Crease, IsNoneOfAPointOnItsMatch) { EXPECT_EQ(crease_of(pi / 4, 0), 0); }

}  // namespace
}  // namespace bespoke
