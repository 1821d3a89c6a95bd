#include "bespoke/anchor_checks/missed_anchors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr double resolution = 0.1;

Anchors four_pairs() {
  Anchors anchors;
  for (const char* name : {"knee", "toe", "heel", ""})
    anchors.pairs.push_back({name, Vector3::Zero(), Vector3::Zero()});
  return anchors;
}

TEST(MissedAnchors, AreThoseBeyondFourSigmaTheWorstFirst) {
  const Anchors anchors = four_pairs();
  const auto missed = missed_anchors(anchors, {4.1, 3.9, 15, 0.5}, {1, 1, 1, 0}, resolution);
  ASSERT_EQ(missed.size(), 3u);
  EXPECT_EQ(missed[0].index, 2u);
  EXPECT_EQ(missed[1].index, 3u);  // exact: five times what remeshing leaves
  EXPECT_EQ(missed[2].index, 0u);
  const std::string text = to_string(missed, anchors);
  EXPECT_THAT(text, ::testing::HasSubstr("\"heel\" is missed by 15, 15 times its sigma"));
  EXPECT_THAT(text, ::testing::HasSubstr("pair 4 is missed by 0.5, though it is exact"));
  EXPECT_LT(text.find("heel"), text.find("knee"));
  EXPECT_EQ(text.find("toe"), std::string::npos);
}

TEST(MissedAnchors, AreNoneWithinSigmaOrResolutionOrWithAWeight) {
  Anchors anchors = four_pairs();
  EXPECT_TRUE(missed_anchors(anchors, {0.3, 4, 0.39, 0}, {0, 1, 1e-9, 0}, resolution).empty());
  anchors.pairs[0].weight = 5;
  EXPECT_TRUE(missed_anchors(anchors, {100, 0, 0, 0}, {0, 0, 0, 0}, resolution).empty());
  EXPECT_EQ(to_string(std::vector<MissedAnchor>{}, anchors), "");
}

TEST(MissedAnchors, NeedsANumberForEachPair) {
  EXPECT_THROW(missed_anchors(four_pairs(), {1}, {1, 1, 1, 1}, resolution), InvalidInput);
  EXPECT_THROW(missed_anchors(four_pairs(), {1, 1, 1, 1}, {}, resolution), InvalidInput);
}

}  // namespace
}  // namespace bespoke
