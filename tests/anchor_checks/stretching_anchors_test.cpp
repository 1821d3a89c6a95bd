#include "bespoke/anchor_checks/stretching_anchors.h"

#include <gtest/gtest.h>

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

std::vector<double> found_sigmas(const Anchors& anchors) {
  return sigmas_within_stretch(anchors, anchors.pairs.size(), max_stretch);
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
  EXPECT_EQ(sigmas_within_stretch(anchors, 8, max_stretch)[7], 0);
  anchors.pairs.back().sigma = 0.1;
  EXPECT_EQ(found_sigmas(anchors)[7], 0);
  anchors.pairs.back().sigma = 0;
  EXPECT_GT(found_sigmas(anchors)[7], 0);
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
