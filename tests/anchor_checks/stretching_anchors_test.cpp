#include "bespoke/anchor_checks/stretching_anchors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace bespoke {
namespace {

constexpr double max_stretch = 10;

/// The corners of a cube of edge 2 onto one of edge 4, and more pairs.
Anchors cube_and(const std::vector<AnchorPair>& more) {
  Anchors anchors;
  for (int k = 0; k < 8; ++k) {
    AnchorPair pair;
    pair.a = Vector3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    pair.b = 2 * pair.a;
    anchors.pairs.push_back(pair);
  }
  anchors.pairs.insert(anchors.pairs.end(), more.begin(), more.end());
  return anchors;
}

AnchorPair pair_of(const Vector3& a, const Vector3& b) {
  AnchorPair pair;
  pair.a = a;
  pair.b = b;
  return pair;
}

/// The cubes of these corners: of edge 2, and of edge 4.
TriangleMesh cube(double half_edge) {
  TriangleMesh mesh{Points(3, 8), Faces(3, 12)};
  for (int k = 0; k < 8; ++k)
    mesh.vertices.col(k) = half_edge * Vector3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
  mesh.faces << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,            //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return mesh;
}

std::vector<double> found_sigmas(const Anchors& anchors, std::size_t count) {
  return sigmas_within_stretch(anchors, count, cube(1), cube(2), max_stretch);
}
std::vector<double> found_sigmas(const Anchors& anchors) {
  return found_sigmas(anchors, anchors.pairs.size());
}

TEST(StretchingAnchors, ShareTheBlame) {
  // One corner clicked twice, 0.01 apart, the targets 0.5.
  const std::vector<double> found = found_sigmas(cube_and({pair_of({1, 1, 1.01}, {2, 2.5, 2})}));
  EXPECT_NEAR(found[7], 0.24, 0.01);
  EXPECT_EQ(found[8], found[7]);
  for (std::size_t k = 0; k < 7; ++k) EXPECT_EQ(found[k], 0) << k;
  // And squeezed: two places onto one.
  const std::vector<double> squeezed = found_sigmas(cube_and({pair_of({1, 1, 1.5}, {2, 2, 2})}));
  EXPECT_NEAR(squeezed[7], 0.5, 0.05);
  EXPECT_EQ(squeezed[8], squeezed[7]);
}

TEST(StretchingAnchors, OneThatIsAstrayLeavesTheOthersExact) {
  for (const double sigma : found_sigmas(cube_and({pair_of({0, 0, 1}, {0, 1000, 2})}))) EXPECT_EQ(sigma, 0);
}

TEST(StretchingAnchors, AreNoneWithinTheBoundOrTheNoiseOfMeshes) {
  EXPECT_EQ(found_sigmas(cube_and({pair_of({1, 1, 1.05}, {2, 2.4, 2})}))[8], 0);      // four times
  EXPECT_EQ(found_sigmas(cube_and({pair_of({1, 1, 1.0001}, {2, 2.005, 2})}))[8], 0);  // remeshing
  EXPECT_EQ(found_sigmas(cube_and({}))[0], 0);
}

TEST(StretchingAnchors, AreExactAndAmongThoseThatAreTested) {
  Anchors anchors = cube_and({pair_of({1, 1, 1.01}, {2, 2.5, 2})});
  EXPECT_EQ(found_sigmas(anchors, 8)[7], 0);
  anchors.pairs.back().sigma = 0.1;
  EXPECT_EQ(found_sigmas(anchors)[7], 0);
  anchors.pairs.back().sigma = 0;
  EXPECT_GT(found_sigmas(anchors)[7], 0);
}

TEST(StretchingAnchors, AreFarApartAlongTheSurfaceWhereTheyContradict) {
  // A strip of length 8, straight and rolled up until its ends nearly touch: no path became any shorter.
  constexpr int count = 81;
  TriangleMesh strip{Points(3, 2 * count), Faces(3, 2 * (count - 1))}, rolled = strip;
  for (int k = 0; k < count; ++k)
    for (int side = 0; side < 2; ++side) {
      const double along = 8.0 * k / (count - 1), radius = 8 / 6.2;
      strip.vertices.col(2 * k + side) << along, 0, 0.1 * side;
      rolled.vertices.col(2 * k + side) << radius * std::cos(along / radius),
          radius * std::sin(along / radius), 0.1 * side;
    }
  for (int k = 0; k + 1 < count; ++k) {
    strip.faces.col(2 * k) << 2 * k, 2 * k + 2, 2 * k + 1;
    strip.faces.col(2 * k + 1) << 2 * k + 1, 2 * k + 2, 2 * k + 3;
  }
  rolled.faces = strip.faces;
  Anchors anchors;
  for (int k = 0; k < count; k += 8)
    anchors.pairs.push_back(pair_of(strip.vertices.col(2 * k), rolled.vertices.col(2 * k)));
  const std::size_t given = anchors.pairs.size();
  for (const double sigma : sigmas_within_stretch(anchors, given, strip, rolled, max_stretch))
    EXPECT_EQ(sigma, 0);
  // Where one end is named twice, the targets being far apart, some path does become longer.
  anchors.pairs.push_back(pair_of(strip.vertices.col(1), rolled.vertices.col(60)));
  const std::vector<double> found = sigmas_within_stretch(anchors, given + 1, strip, rolled, max_stretch);
  EXPECT_GT(found.front(), 0.1);
  EXPECT_EQ(found.back(), found.front());
}

TEST(StretchingAnchors, BearFewPairsAndPairsAtOnePlace) {
  EXPECT_TRUE(found_sigmas({}).empty());
  Anchors few;
  few.pairs = {pair_of({0, 0, 0}, {0, 0, 0}), pair_of({0, 0, 0}, {0, 0, 1})};
  EXPECT_EQ(found_sigmas(few), (std::vector<double>{0, 0}));
  few.pairs.resize(6, few.pairs[0]);
  EXPECT_EQ(found_sigmas(few), std::vector<double>(6, 0));
}

}  // namespace
}  // namespace bespoke
