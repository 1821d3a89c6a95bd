#include "bespoke/lattice/pyramid.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "bespoke/error.h"

namespace bespoke {
namespace {

using testing::HasSubstr;

Pyramid two_levels() {
  Pyramid pyramid;
  pyramid.levels.push_back({0.5, {{0, 0, 0}, {1, 0, 0}}, std::vector<float>(2 * 3 * leaf_nodes, 1.0f)});
  pyramid.levels.push_back({0.25, {{1, 0, 1}, {3, 1, 0}}, std::vector<float>(2 * 3 * leaf_nodes, 1.0f)});
  return pyramid;
}

void expect_refused(const Pyramid& pyramid, const std::string& why) {
  try {
    require_valid(pyramid);
    ADD_FAILURE() << "accepted; expected: " << why;
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr(why));
  }
}

TEST(RequireValidPyramid, AcceptsNestedLevelsAndNoLevel) {
  EXPECT_NO_THROW(require_valid(two_levels()));
  EXPECT_NO_THROW(require_valid(Pyramid{}));
  EXPECT_EQ(two_levels().voxel_count(), 4u * leaf_nodes);
  EXPECT_EQ(two_levels().byte_count(), 4u * (leaf_nodes * 12 + 12));
}

TEST(RequireValidPyramid, NamesWhatIsWrong) {
  Pyramid pyramid = two_levels();
  pyramid.levels[1].voxel_size = 0.3;
  expect_refused(pyramid, "level 1: voxel size 0.3");
  pyramid = two_levels();
  pyramid.levels[0].voxel_size = std::numeric_limits<double>::quiet_NaN();
  expect_refused(pyramid, "level 0: voxel size");
  pyramid = two_levels();
  pyramid.levels[1].leaves[1] = {4, 0, 0};
  expect_refused(pyramid, "leaf (4, 0, 0) has no leaf above it");
  pyramid = two_levels();
  std::swap(pyramid.levels[0].leaves[0], pyramid.levels[0].leaves[1]);
  expect_refused(pyramid, "order");
  pyramid = two_levels();
  pyramid.levels[0].leaves[1] = pyramid.levels[0].leaves[0];
  expect_refused(pyramid, "twice");
  pyramid = two_levels();
  pyramid.levels[0].values[3 * leaf_nodes] = std::numeric_limits<float>::infinity();
  expect_refused(pyramid, "leaf (1, 0, 0) is not finite");
  pyramid = two_levels();
  pyramid.levels[0].values.pop_back();
  expect_refused(pyramid, "values");
  pyramid = two_levels();
  pyramid.levels[1].leaves.clear();
  pyramid.levels[1].values.clear();
  expect_refused(pyramid, "no leaf");
  pyramid = two_levels();
  pyramid.levels[0].leaves[1] = {std::numeric_limits<int>::max(), 0, 0};
  expect_refused(pyramid, "out of range");
  pyramid = two_levels();
  pyramid.origin.x() = std::numeric_limits<double>::quiet_NaN();
  expect_refused(pyramid, "origin");
}

TEST(RoundValues, MovesNothingByMoreThanA64thOfTheToleranceAndLeavesFewBits) {
  constexpr double tolerance = 0.3;
  std::mt19937 engine(5);
  std::uniform_real_distribution<float> value(-20, 20);
  std::vector<float> values{0};
  while (values.size() < 1000) values.push_back(value(engine));
  std::vector<float> rounded = values;
  round_values(rounded, tolerance, ValuePrecision::single);
  EXPECT_EQ(rounded[0], 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_LE(std::abs(rounded[i] - values[i]), tolerance / 64);
    ASSERT_EQ(std::remainder(rounded[i], 0x1p-7f), 0);  // tolerance / 64 < 2^-7 <= tolerance / 32
  }
  std::vector<float> again = rounded;
  round_values(again, tolerance, ValuePrecision::single);
  EXPECT_EQ(again, rounded);
}

}  // namespace
}  // namespace bespoke
