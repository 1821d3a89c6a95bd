#include "bespoke/anchors/swapped_anchors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "bespoke/error.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

/// Points of a ball and their places after a smooth bend.
Anchors bent_pairs(Eigen::Index count) {
  Anchors anchors;
  const Points sources = test::random_points(count, 3);
  for (const auto& a : sources.colwise()) {
    AnchorPair pair{"p", a, Vector3(a[0] + 0.2 * a[1] * a[1], 1.1 * a[1] + 0.2 * std::sin(a[2]), 0.9 * a[2])};
    pair.name += std::to_string(anchors.pairs.size());
    anchors.pairs.push_back(pair);
  }
  return anchors;
}

void interchange(Anchors& anchors, std::size_t i, std::size_t j) {
  std::swap(anchors.pairs[i].b, anchors.pairs[j].b);
}

TEST(SwappedAnchors, AreNoneAmongRightPairs) {
  EXPECT_TRUE(swapped_anchors(bent_pairs(24)).empty());
  Anchors affine = bent_pairs(24);
  for (AnchorPair& pair : affine.pairs) pair.b = 2 * pair.a + Vector3(5, 0, 1);
  EXPECT_TRUE(swapped_anchors(affine).empty());
  EXPECT_EQ(to_string(std::vector<SwappedAnchors>{}, affine), "");
}

TEST(SwappedAnchors, AreFoundWhicheverTheyAre) {
  for (std::size_t other = 1; other < 24; ++other) {
    Anchors anchors = bent_pairs(24);
    interchange(anchors, 0, other);
    const auto found = swapped_anchors(anchors);
    ASSERT_EQ(found.size(), 1u) << other;
    EXPECT_EQ(found[0].first, 0u);
    EXPECT_EQ(found[0].second, other);
    EXPECT_LE(found[0].energy_ratio, 0.7);
    EXPECT_NE(to_string(found, anchors).find(label(anchors, 0) + " and " + label(anchors, other)),
              std::string::npos);
  }
}

TEST(SwappedAnchors, AreNoneWhereOneAloneIsAnOutlier) {
  const Points directions = test::random_points(24, 8);
  for (const double length : {0.3, 1.0, 3.0, 1000.0})
    for (std::size_t i = 0; i < 24; ++i) {
      Anchors anchors = bent_pairs(24);
      anchors.pairs[i].b += length * directions.col(static_cast<Eigen::Index>(i)).normalized();
      EXPECT_TRUE(swapped_anchors(anchors).empty()) << i << " displaced by " << length;
    }
}

TEST(SwappedAnchors, AreFoundTwice) {
  Anchors anchors = bent_pairs(24);
  interchange(anchors, 2, 17);
  interchange(anchors, 5, 11);
  const auto found = swapped_anchors(anchors);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].first + found[1].first, 7u);
  EXPECT_EQ(found[0].second + found[1].second, 28u);
}

TEST(SwappedAnchors, NeedEnoughPairsAndFiniteOnes) {
  Anchors anchors = bent_pairs(5);
  interchange(anchors, 0, 1);
  EXPECT_TRUE(swapped_anchors(anchors).empty());
  EXPECT_TRUE(swapped_anchors({}).empty());
  anchors.pairs[2].a[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(swapped_anchors(anchors), InvalidInput);
}

}  // namespace
}  // namespace bespoke
