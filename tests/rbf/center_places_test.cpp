#include "bespoke/rbf/center_places.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/instruction_sets.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

double distance(const Vector3& low, const Vector3& high, const Vector3& x) {
  return (low - x).cwiseMax(x - high).cwiseMax(0.0).norm();
}

std::vector<int> near(const CenterPlaces& places, const std::vector<CenterPlaces::Range>& ranges,
                      const Vector3& low, const Vector3& high) {
  std::vector<int> found;
  places.append_near(ranges, low.data(), high.data(), found);
  return found;
}

TEST(CenterPlaces, MissesNoCenterWithinReachAndKeepsNoneMuchFarther) {
  for (const double offset : {0.0, 1e4, 1e7})
    for (const double reach : {0.05, 0.4, 3.0}) {
      const Points centers = test::random_points(300, 1).colwise() + Vector3(offset, -offset, 2 * offset);
      const CenterPlaces places(centers, reach);
      // What a double loses of a coordinate so far away is no nearness.
      const double slack = 1e-6 + 1e-15 * offset;
      for (int box = 0; box < 50; ++box) {
        const Points corners = test::random_points(2, 10 + box);
        const Vector3 origin(offset, -offset, 2 * offset);
        const Vector3 low = corners.rowwise().minCoeff() + origin,
                      high = corners.rowwise().maxCoeff() + origin;
        std::vector<bool> kept(300, false);
        for (const int position : near(places, {{0, 300}}, low, high)) kept[std::size_t(position)] = true;
        for (int i = 0; i < 300; ++i) {
          const double found = distance(low, high, centers.col(i));
          const bool is_kept = kept[std::size_t(i)];
          EXPECT_TRUE(is_kept || found >= reach) << found << " of " << reach;
          EXPECT_TRUE(!is_kept || found <= reach + 4 * slack) << found << " of " << reach;
        }
      }
    }
}

TEST(CenterPlaces, LooksOnlyAtTheRangesInTheirOrder) {
  const Points centers = 0.1 * test::random_points(100, 3);
  const CenterPlaces places(centers, 10);
  const std::vector<int> found = near(places, {{40, 43}, {7, 8}, {99, 100}}, {0, 0, 0}, {0, 0, 0});
  EXPECT_EQ(found, (std::vector<int>{40, 41, 42, 7, 99}));
  EXPECT_TRUE(near(places, {}, {0, 0, 0}, {0, 0, 0}).empty());
}

TEST(CenterPlaces, FindsTheSameWithEveryInstructionSet) {
  const CenterPlaces places(test::random_points(1000, 4), 0.3);
  test::expect_same_bits_with_every_instruction_set([&] {
    const std::vector<int> found = near(places, {{3, 500}, {501, 1000}}, {0.1, 0, -0.2}, {0.3, 0.1, 0});
    return std::vector<double>(found.begin(), found.end());
  });
}

}  // namespace
}  // namespace bespoke
