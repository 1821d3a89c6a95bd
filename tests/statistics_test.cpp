#include "bespoke/statistics.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

TEST(Summarize, ReportsOnlyValuesOfTheSample) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const Statistics statistics = summarize(values);
  EXPECT_EQ(statistics.count, 100u);
  EXPECT_EQ(statistics.min, 1);
  EXPECT_EQ(statistics.median, 50);
  EXPECT_EQ(statistics.p95, 95);
  EXPECT_EQ(statistics.p99, 99);
  EXPECT_EQ(statistics.max, 100);
}

TEST(Summarize, AgreesWithTheRanksOfTheSortedValues) {
  std::mt19937_64 engine(1);
  for (std::size_t count = 1; count < 250; ++count) {
    std::vector<double> values(count);
    for (double& value : values) value = static_cast<double>(engine() % 100);  // with ties
    const std::vector<double> sorted = sorted_finite(values);
    const Statistics statistics = summarize(values);
    EXPECT_EQ(statistics.min, sorted.front());
    EXPECT_EQ(statistics.median, nearest_rank(sorted, 0.5));
    EXPECT_EQ(statistics.p95, nearest_rank(sorted, 0.95));
    EXPECT_EQ(statistics.p99, nearest_rank(sorted, 0.99));
    EXPECT_EQ(statistics.max, sorted.back());
  }
}

TEST(Summarize, OfNothingCountsZero) { EXPECT_EQ(summarize({}).count, 0u); }

TEST(Summarize, RefusesNaN) {
  EXPECT_THROW(summarize({1.0, std::numeric_limits<double>::quiet_NaN()}), InvalidInput);
}

TEST(ParallelReduce, CombinesChunksInOrder) {
  const auto text = parallel_reduce(
      10, 3, std::string(), [](std::size_t begin, std::size_t end) { return std::to_string(end - begin); },
      [](const std::string& a, const std::string& b) { return a + b; });
  EXPECT_EQ(text, "3331");
}

TEST(ParallelFor, PassesOnTheBodysException) {
  EXPECT_THROW(parallel_for(5, 1, [](std::size_t, std::size_t) { throw SolverError("residual 1"); }),
               SolverError);
}

}  // namespace
}  // namespace bespoke
