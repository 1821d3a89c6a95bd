#include "bespoke/anchors/detail/isotonic_regression.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace bespoke {
namespace {

using ::testing::ElementsAre;

double squares(const std::vector<SlidingValue>& values, const std::vector<double>& other) {
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    sum += (values[i].value - other[i]) * (values[i].value - other[i]);
  return sum;
}

std::vector<SlidingValue> random_values(std::size_t count, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> noise(-2, 2);
  std::vector<SlidingValue> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back({0.3 * static_cast<double>(i) + noise(engine)});
  return values;
}

TEST(NearestRising, LeavesWhatRises) {
  EXPECT_THAT(nearest_rising({{1}, {2}, {2}, {5}}), ElementsAre(1, 2, 2, 5));
  EXPECT_THAT(nearest_rising({}), ElementsAre());
}

TEST(NearestRising, TakesTheMeanOfWhatFalls) {
  EXPECT_THAT(nearest_rising({{0}, {3}, {1}, {5}}), ElementsAre(0, 2, 2, 5));
  EXPECT_THAT(nearest_rising({{3}, {2}, {1}}), ElementsAre(2, 2, 2));
}

// No step from it along which it still rises is nearer: the set of rising sequences is convex.
TEST(NearestRising, IsTheNearest) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> step(0, 0.5);
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<SlidingValue> values = random_values(30, seed);
    const std::vector<double> rising = nearest_rising(values);
    EXPECT_TRUE(std::is_sorted(rising.begin(), rising.end()));
    for (int trial = 0; trial < 50; ++trial) {
      std::vector<double> other = rising;
      for (double& value : other) value += step(engine) - 0.25;
      std::sort(other.begin(), other.end());
      EXPECT_LE(squares(values, rising), squares(values, other) + 1e-12);
    }
  }
}

TEST(NearestRising, KeepsFixedValues) {
  EXPECT_THAT(nearest_rising({{4}, {2, true}, {1}, {9}, {3, true}, {2}}), ElementsAre(2, 2, 2, 3, 3, 3));
}

TEST(NearestRising, StaysWithinBounds) {
  EXPECT_THAT(nearest_rising({{-4}, {2}, {1}, {9}}, 0, 5), ElementsAre(0, 1.5, 1.5, 5));
}

TEST(NearestRisingRound, HasNoEnds) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<SlidingValue> values = random_values(20, seed);
    const double turn = 6;  // as much as the values rise
    std::vector<SlidingValue> begun_later(values.begin() + 7, values.end());
    for (std::size_t i = 0; i < 7; ++i) begun_later.push_back({values[i].value + turn});
    const std::vector<double> rising = nearest_rising_round(values, turn);
    const std::vector<double> later = nearest_rising_round(begun_later, turn);
    for (std::size_t i = 7; i < values.size(); ++i) EXPECT_DOUBLE_EQ(rising[i], later[i - 7]);
    EXPECT_GE(rising.front() + turn + 1e-12, rising.back());
  }
}

}  // namespace
}  // namespace bespoke
