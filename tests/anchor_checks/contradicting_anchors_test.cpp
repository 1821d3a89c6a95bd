#include "bespoke/anchor_checks/contradicting_anchors.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <utility>

#include "support/random_points.h"

namespace bespoke {
namespace {

constexpr double near = 0.01;

Matrix3 similar_turn() {
  return 1.7 * Eigen::AngleAxisd(0.8, Vector3(1, 2, 3).normalized()).toRotationMatrix();
}

/// Spread pairs under one similarity, and two more so close together that they lie `near` apart.
Anchors similar_with_twins() {
  Anchors anchors;
  const Points x = test::random_points(20, 5);
  const Matrix3 turn = similar_turn();
  for (const auto& a : x.colwise()) anchors.pairs.push_back({"", a, turn * a + Vector3(3, 0, 1)});
  AnchorPair twin = anchors.pairs.front();
  anchors.pairs.front().name = "left";
  twin.name = "right";
  twin.a += Vector3(near, 0, 0);
  twin.b += turn * Vector3(near, 0, 0);
  anchors.pairs.push_back(twin);
  return anchors;
}

TEST(ContradictingAnchors, AreNoneUnderASimilarity) {
  EXPECT_TRUE(contradicting_anchors(similar_with_twins()).empty());
  EXPECT_EQ(to_string(std::vector<ContradictingAnchors>{}, similar_with_twins()), "");
}

TEST(ContradictingAnchors, AreThoseMovedFartherThanTheyAreApart) {
  for (const double share : {0.5, 0.9, 1.1, 4.0}) {
    Anchors anchors = similar_with_twins();
    anchors.pairs.back().b += share * 1.7 * near * Vector3(0, 1, 0);
    const auto found = contradicting_anchors(anchors);
    ASSERT_EQ(found.size(), share > 1 ? 1u : 0u) << share;
    if (found.empty()) continue;
    EXPECT_EQ(found[0].first, 0u);
    EXPECT_EQ(found[0].second, 20u);
    EXPECT_NEAR(found[0].source_distance, 1.7 * near,
                0.05 * near);  // one moved pair of 21 moves the similarity a little
    EXPECT_NEAR(found[0].target_difference, share * 1.7 * near, 0.05 * near);
    EXPECT_NE(to_string(found, anchors).find("\"left\" and \"right\""), std::string::npos);
  }
}

TEST(ContradictingAnchors, MayBeFarApartOrSoft) {
  Anchors anchors = similar_with_twins();
  anchors.pairs[3].b += Vector3(2, 0, 0);
  EXPECT_TRUE(contradicting_anchors(anchors).empty());
  anchors = similar_with_twins();
  anchors.pairs.back().b += Vector3(0, 4 * near, 0);
  anchors.pairs.back().weight = 10;
  EXPECT_TRUE(contradicting_anchors(anchors).empty());
}

// A hand that has flipped: its fingers' tips go where one similarity of all anchors would not take them.
TEST(ContradictingAnchors, MayTurnWithThoseAroundThem) {
  Anchors anchors = similar_with_twins();
  const Vector3 center = anchors.pairs.front().a, image = anchors.pairs.front().b;
  const Matrix3 over = -Matrix3::Identity() + 2 * Vector3::UnitZ() * Vector3::UnitZ().transpose();
  anchors.pairs.back().b = image + over * (anchors.pairs.back().b - image);
  EXPECT_EQ(contradicting_anchors(anchors).size(), 1u);
  const Points around = 3 * near * test::random_points(6, 11);
  for (const auto& a : around.colwise()) {
    AnchorPair pair = anchors.pairs.front();
    pair.a = center + a;
    pair.b = image + over * (similar_turn() * a);
    anchors.pairs.push_back(pair);
  }
  EXPECT_TRUE(contradicting_anchors(anchors).empty());
  const std::size_t last = anchors.pairs.size() - 1;
  std::swap(anchors.pairs[last].b, anchors.pairs[last - 1].b);
  const auto found = contradicting_anchors(anchors);
  ASSERT_FALSE(found.empty());
  for (const ContradictingAnchors& pair : found) EXPECT_GE(pair.second, last - 1);
}

TEST(ContradictingAnchors, AtOnePlaceMustGoToOne) {
  Anchors anchors = similar_with_twins();
  anchors.pairs.back().a = anchors.pairs.front().a;
  EXPECT_EQ(contradicting_anchors(anchors).size(), 1u);
  anchors.pairs.back().b = anchors.pairs.front().b;
  EXPECT_TRUE(contradicting_anchors(anchors).empty());
}

TEST(ContradictingAnchors, BearsFewPairsAndPairsAtOnePlace) {
  EXPECT_TRUE(contradicting_anchors({}).empty());
  Anchors anchors;
  anchors.pairs.assign(6, {"", Vector3(1, 2, 3), Vector3(4, 5, 6)});
  EXPECT_TRUE(contradicting_anchors(anchors).empty());
}

}  // namespace
}  // namespace bespoke
