#include "bespoke/batch/forecast.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "batch/batch_scene.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;

JobGraph graph_of_pairs(test::BatchScene& scene, std::size_t pairs) {
  scene.write("a", "A");
  std::vector<BatchJob> jobs;
  for (std::size_t i = 0; i < pairs; ++i) {
    const std::string name = std::to_string(i);
    jobs.push_back(scene.job(2 * i + 1, {"a"}, {"x" + name}));
    jobs.push_back(scene.job(2 * i + 2, {"x" + name}, {"y" + name}));
  }
  return make_job_graph(std::move(jobs));
}

TEST(ForecastJobs, GrowsWithTheInputs) {
  test::BatchScene scene;
  scene.write("small", "s");
  scene.write("large", std::string(5'000'000, 'l'));
  const auto forecasts =
      forecast_jobs(make_job_graph({scene.job(1, {"small"}, {"b"}), scene.job(2, {"large"}, {"c"})}));
  EXPECT_GT(forecasts[0].seconds, 0);
  EXPECT_GT(forecasts[1].seconds, forecasts[0].seconds);
  EXPECT_GT(forecasts[1].memory, forecasts[0].memory);
}

TEST(ForecastJobs, DoesNotLookAtWhatJobsHaveWritten) {
  test::BatchScene scene;
  const double before = forecast_jobs(graph_of_pairs(scene, 1))[1].seconds;
  scene.write("x0", std::string(3'000'000, 'x'));
  EXPECT_EQ(forecast_jobs(graph_of_pairs(scene, 1))[1].seconds, before);
}

TEST(JobsOfShard, AreAllJobsOnceWithWhatTheyNeed) {
  test::BatchScene scene;
  const JobGraph graph = graph_of_pairs(scene, 7);
  const auto forecasts = forecast_jobs(graph);
  for (const std::size_t count : {1, 2, 3, 7, 20}) {
    std::multiset<std::size_t> all;
    for (std::size_t index = 0; index < count; ++index) {
      const auto mine = jobs_of_shard(graph, forecasts, index, count);
      EXPECT_TRUE(std::is_sorted(mine.begin(), mine.end()));
      for (const std::size_t job : mine) {
        all.insert(job);
        EXPECT_TRUE(std::binary_search(mine.begin(), mine.end(), job ^ 1));
      }
    }
    EXPECT_EQ(all.size(), graph.jobs.size());
    EXPECT_EQ(std::set<std::size_t>(all.begin(), all.end()).size(), graph.jobs.size());
  }
}

TEST(JobsOfShard, BalancesByCostNotByCount) {
  test::BatchScene scene;
  scene.write("a", "A");
  std::vector<BatchJob> jobs;
  std::vector<JobForecast> forecasts;
  for (std::size_t i = 0; i < 11; ++i) {
    jobs.push_back(scene.job(i + 1, {"a"}, {"o" + std::to_string(i)}));
    forecasts.push_back({i == 4 ? 10.0 : 1.0, 1, 0});
  }
  const JobGraph graph = make_job_graph(std::move(jobs));
  EXPECT_THAT(jobs_of_shard(graph, forecasts, 0, 2), ElementsAre(4));
  EXPECT_EQ(jobs_of_shard(graph, forecasts, 1, 2).size(), 10u);
}

}  // namespace
}  // namespace bespoke
