#include "bespoke/registration/detail/rejected_anchors.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace bespoke {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::size_t> numbers(const std::vector<RejectedAnchor>& anchors) {
  std::vector<std::size_t> all;
  for (const RejectedAnchor& anchor : anchors) all.push_back(anchor.index);
  return all;
}

bool has(const std::vector<std::size_t>& all, std::size_t index) {
  return std::find(all.begin(), all.end(), index) != all.end();
}

TEST(RejectedAnchors, AreWrongPairsAndNoRightOneThatOnlyItsNeighboursHold) {
  // 3 is an outlier; 5 is right, but lies elsewhere where 4, which is right whatever is left out,
  // does not hold it.
  const auto outliers_and_inliers = [](const std::vector<std::size_t>& left_out) {
    std::vector<RejectedAnchor> rejected;
    for (const std::size_t index : left_out)
      if (index == 3 || (index == 5 && has(left_out, 4))) rejected.push_back({index, 0.1});
    return rejected;
  };
  EXPECT_THAT(numbers(rejected_anchors({3, 4, 5}, outliers_and_inliers)), ElementsAre(3));
  EXPECT_THAT(numbers(rejected_anchors({4, 5}, outliers_and_inliers)), IsEmpty());
  EXPECT_THAT(numbers(rejected_anchors({3}, outliers_and_inliers)), ElementsAre(3));
  EXPECT_THAT(numbers(rejected_anchors({}, outliers_and_inliers)), IsEmpty());
}

TEST(RejectedAnchors, AloneAreThoseThatNoNeighbourHolds) {
  const auto held_by_each_other = [](const std::vector<std::size_t>& left_out) {
    std::vector<RejectedAnchor> rejected;
    for (const std::size_t index : left_out)
      if (index == 3 || left_out.size() > 1) rejected.push_back({index, 0.1});
    return rejected;
  };
  const std::vector<RejectedAnchor> together = rejected_anchors({3, 4, 5}, held_by_each_other);
  EXPECT_THAT(numbers(together), ElementsAre(3, 4, 5));
  EXPECT_THAT(rejected_alone(together, held_by_each_other), ElementsAre(3));
}

TEST(RejectedAnchors, AreToldByTheDistanceOfTheLastTime) {
  const auto nearer_alone = [](const std::vector<std::size_t>& left_out) {
    std::vector<RejectedAnchor> rejected = {{7, double(left_out.size())}};
    return rejected;
  };
  const std::vector<RejectedAnchor> found = rejected_anchors({2, 7, 8}, nearer_alone);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].distance, 1);
}

TEST(RejectedAnchors, AreReinstatedNearestFirstEachBesideThoseStillRejected) {
  // 4 is right once 3, which is an outlier, is left out; 5 once 4 is back.
  std::vector<std::size_t> asked;
  const auto reinstate = [&](std::size_t anchor, const std::vector<std::size_t>& others) {
    asked.push_back(anchor);
    return has(others, 3) && (anchor == 4 || (anchor == 5 && !has(others, 4)));
  };
  const std::vector<RejectedAnchor> rejected = {{3, 0.9}, {4, 0.1}, {5, 0.2}};
  EXPECT_THAT(numbers(not_reinstated(rejected, reinstate)), ElementsAre(3));
  EXPECT_THAT(asked, ElementsAre(4, 5, 3));
  const std::vector<RejectedAnchor> in_turn = {{3, 0.9}, {4, 0.2}, {5, 0.1}};
  EXPECT_THAT(numbers(not_reinstated(in_turn, reinstate)), ElementsAre(3, 5));
}

}  // namespace
}  // namespace bespoke
