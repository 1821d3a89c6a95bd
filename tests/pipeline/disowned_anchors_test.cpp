#include "bespoke/pipeline/disowned_anchors.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace bespoke {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::size_t> numbers(const std::vector<LeftOutAnchor>& anchors) {
  std::vector<std::size_t> all;
  for (const LeftOutAnchor& anchor : anchors) all.push_back(anchor.index);
  return all;
}

bool has(const std::vector<std::size_t>& all, std::size_t index) {
  return std::find(all.begin(), all.end(), index) != all.end();
}

TEST(DisownedAnchors, AreWrongPairsAndNoRightOneThatOnlyItsNeighboursHold) {
  // 3 has slipped; 5 is right, but lies elsewhere where 4, which is right whatever is left out, does not
  // hold it.
  const auto slipped_and_held = [](const std::vector<std::size_t>& left_out) {
    std::vector<LeftOutAnchor> disowned;
    for (const std::size_t index : left_out)
      if (index == 3 || (index == 5 && has(left_out, 4))) disowned.push_back({index, 0.1});
    return disowned;
  };
  EXPECT_THAT(numbers(disowned_anchors({3, 4, 5}, slipped_and_held)), ElementsAre(3));
  EXPECT_THAT(numbers(disowned_anchors({4, 5}, slipped_and_held)), IsEmpty());
  EXPECT_THAT(numbers(disowned_anchors({3}, slipped_and_held)), ElementsAre(3));
  EXPECT_THAT(numbers(disowned_anchors({}, slipped_and_held)), IsEmpty());
}

TEST(DisownedAnchors, AloneAreThoseThatNoNeighbourHolds) {
  const auto held_by_each_other = [](const std::vector<std::size_t>& left_out) {
    std::vector<LeftOutAnchor> disowned;
    for (const std::size_t index : left_out)
      if (index == 3 || left_out.size() > 1) disowned.push_back({index, 0.1});
    return disowned;
  };
  const std::vector<LeftOutAnchor> together = disowned_anchors({3, 4, 5}, held_by_each_other);
  EXPECT_THAT(numbers(together), ElementsAre(3, 4, 5));
  EXPECT_THAT(disowned_alone(together, held_by_each_other), ElementsAre(3));
}

TEST(DisownedAnchors, AreToldByTheDistanceOfTheLastTime) {
  const auto nearer_alone = [](const std::vector<std::size_t>& left_out) {
    std::vector<LeftOutAnchor> disowned = {{7, double(left_out.size())}};
    return disowned;
  };
  const std::vector<LeftOutAnchor> found = disowned_anchors({2, 7, 8}, nearer_alone);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].distance, 1);
}

TEST(DisownedAnchors, AreTakenBackNearestFirstEachBesideThoseStillLeftOut) {
  // 4 is right once 3, which has slipped, is left out; 5 once 4 is back.
  std::vector<std::size_t> asked;
  const auto take_back = [&](std::size_t anchor, const std::vector<std::size_t>& others) {
    asked.push_back(anchor);
    return has(others, 3) && (anchor == 4 || (anchor == 5 && !has(others, 4)));
  };
  const std::vector<LeftOutAnchor> disowned = {{3, 0.9}, {4, 0.1}, {5, 0.2}};
  EXPECT_THAT(numbers(not_taken_back(disowned, take_back)), ElementsAre(3));
  EXPECT_THAT(asked, ElementsAre(4, 5, 3));
  const std::vector<LeftOutAnchor> in_turn = {{3, 0.9}, {4, 0.2}, {5, 0.1}};
  EXPECT_THAT(numbers(not_taken_back(in_turn, take_back)), ElementsAre(3, 5));
}

}  // namespace
}  // namespace bespoke
