#include "bespoke/batch/run_batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <thread>

#include "batch/batch_scene.h"

namespace bespoke {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

class RunBatch : public ::testing::Test {
 protected:
  RunBatch() {
    scene_.write("a", "A");
    scene_.write("bad", "bad");
  }

  static constexpr std::size_t memory = std::size_t{1} << 34;

  static BatchOptions limits(int threads, int jobs, std::size_t max_memory = memory) {
    BatchOptions options;
    options.threads = threads;
    options.jobs = jobs;
    options.max_memory = max_memory;
    return options;
  }

  std::vector<JobState> run(std::vector<BatchJob> jobs, BatchOptions options = limits(4, 4)) {
    const JobGraph graph = make_job_graph(std::move(jobs));
    EXPECT_TRUE(graph.faults.empty());
    results_ = run_batch(graph, forecast_jobs(graph), options, events_);
    std::vector<JobState> states;
    for (const JobResult& result : results_) states.push_back(result.state);
    return states;
  }

  /// 1 → (2, 3, …, count − 1) → count.
  std::vector<BatchJob> diamond(std::size_t count) {
    std::vector<BatchJob> jobs{scene_.job(1, {"a"}, {"start"})};
    std::vector<std::string> middle;
    for (std::size_t line = 2; line < count; ++line) {
      middle.push_back("m" + std::to_string(line));
      jobs.push_back(scene_.job(line, {"start", "a"}, {middle.back()}));
    }
    jobs.push_back(scene_.job(count, middle, {"out/end"}));
    return jobs;
  }

  test::BatchScene scene_;
  BatchEvents events_;
  std::vector<JobResult> results_;
};

TEST_F(RunBatch, RunsAJobOnceAllThatItNeedsIsDone) {
  for (const int workers : {1, 3, 8}) {
    scene_.ran.clear();
    std::filesystem::remove_all(scene_.file("out"));
    std::filesystem::remove(scene_.file("start"));
    for (int i = 2; i < 40; ++i) std::filesystem::remove(scene_.file("m" + std::to_string(i)));
    EXPECT_THAT(run(diamond(40), limits(workers, workers)), Each(JobState::done));
    EXPECT_EQ(scene_.ran.front(), 1u);
    EXPECT_EQ(scene_.ran.back(), 40u);
    EXPECT_EQ(scene_.read("out/end").size(), 2u * 38);
  }
}

TEST_F(RunBatch, RepeatsOnlyWhatHasChanged) {
  run(diamond(6));
  scene_.ran.clear();
  EXPECT_THAT(run(diamond(6)), Each(JobState::up_to_date));
  EXPECT_THAT(scene_.ran, SizeIs(0));
  std::filesystem::remove(scene_.file("m3"));
  run(diamond(6));
  EXPECT_THAT(scene_.ran, ElementsAre(3));  // whose bytes are the same, so that nothing follows
  scene_.ran.clear();
  scene_.write("a", "B");
  run(diamond(6));
  EXPECT_THAT(scene_.ran, UnorderedElementsAre(1, 2, 3, 4, 5, 6));
}

TEST_F(RunBatch, StopsAtAFailureOrGoesOn) {
  const auto jobs = [&] {
    return std::vector{scene_.job(1, {"bad"}, {"b"}), scene_.job(2, {"b"}, {"c"}),
                       scene_.job(3, {"a"}, {"d"})};
  };
  EXPECT_THAT(run(jobs(), limits(1, 1)), ElementsAre(JobState::failed, JobState::not_run, JobState::not_run));
  EXPECT_THAT(results_[0].error, HasSubstr("the text is bad"));
  BatchOptions going_on = limits(1, 1);
  going_on.keep_going = true;
  EXPECT_THAT(run(jobs(), going_on), ElementsAre(JobState::failed, JobState::not_run, JobState::done));
}

TEST_F(RunBatch, StopsBetweenJobs) {
  std::atomic<int> ended = 0;
  events_.ended = [&](std::size_t, const JobResult&) { ++ended; };
  BatchOptions options = limits(1, 1);
  options.stop = [&] { return ended >= 3; };
  const std::vector<JobState> states = run(diamond(10), options);
  EXPECT_EQ(std::count(states.begin(), states.end(), JobState::done), 3);
  EXPECT_EQ(std::count(states.begin(), states.end(), JobState::not_run), 7);
  EXPECT_THAT(scene_.ran, SizeIs(3));
}

TEST_F(RunBatch, KeepsTheForecastsOfRunningJobsWithinTheMemory) {
  std::atomic<int> running = 0, most = 0;
  std::vector<BatchJob> jobs;
  for (std::size_t line = 1; line <= 12; ++line) {
    BatchJob job = scene_.job(line, {"a"}, {"o" + std::to_string(line)});
    job.run = [&, run = job.run](const Progress& progress) {
      most = std::max<int>(most, ++running);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      --running;
      return run(progress);
    };
    jobs.push_back(std::move(job));
  }
  const JobGraph graph = make_job_graph(jobs);
  const std::vector<JobForecast> forecasts(jobs.size(), JobForecast{1, 100, 0});
  run_batch(graph, forecasts, limits(8, 8, 250));
  EXPECT_LE(most, 2);
  // One that is larger than all of it runs alone.
  for (std::size_t line = 1; line <= 12; ++line)
    std::filesystem::remove(scene_.file("o" + std::to_string(line)));
  most = 0;
  run_batch(graph, forecasts, limits(8, 8, 50));
  EXPECT_EQ(most, 1);
}

TEST_F(RunBatch, CountsASharedMapOnceAndClosesItAfterItsLastUser) {
  std::vector<BatchJob> jobs;
  for (std::size_t line = 1; line <= 4; ++line) {
    jobs.push_back(scene_.job(line, {"a"}, {"o" + std::to_string(line)}));
    jobs.back().shared_map = scene_.file("a");
  }
  std::vector<std::filesystem::path> closed;
  std::atomic<std::size_t> ended = 0;
  events_.ended = [&](std::size_t, const JobResult&) { ++ended; };
  events_.close_map = [&](const std::filesystem::path& map) {
    EXPECT_EQ(ended, 3u);  // told before the end of the last
    closed.push_back(map);
  };
  const JobGraph graph = make_job_graph(jobs);
  const std::vector<JobForecast> forecasts(4, JobForecast{1, 10, 1000});
  const std::vector<JobResult> results = run_batch(graph, forecasts, limits(4, 4, 1100), events_);
  for (const JobResult& result : results) EXPECT_EQ(result.state, JobState::done);
  EXPECT_THAT(closed, ElementsAre(scene_.file("a")));
}

TEST_F(RunBatch, GivesTheThreadsThatAreLeftToALargeJob) {
  std::vector<BatchJob> jobs{scene_.job(1, {"a"}, {"large"}), scene_.job(2, {"a"}, {"small"})};
  // The large one is there until the small one runs, which alone would get all threads.
  std::promise<void> small_runs;
  jobs[0].run = [run = jobs[0].run, ran = small_runs.get_future().share()](const Progress& progress) {
    ran.wait_for(std::chrono::seconds(60));
    return run(progress);
  };
  jobs[1].run = [run = jobs[1].run, &small_runs](const Progress& progress) {
    small_runs.set_value();
    return run(progress);
  };
  const JobGraph graph = make_job_graph(std::move(jobs));
  const std::vector<JobResult> results =
      run_batch(graph, {JobForecast{100, 1, 0}, JobForecast{1, 1, 0}}, limits(4, 4));
  EXPECT_GE(results[0].threads, 3);  // the other may have started first
  EXPECT_EQ(results[1].threads, 1);
}

TEST_F(RunBatch, RefusesAGraphWithFaults) {
  const JobGraph graph = make_job_graph({scene_.job(1, {"absent"}, {"b"})});
  EXPECT_THROW(run_batch(graph, forecast_jobs(graph), limits(1, 1)), InvalidInput);
}

}  // namespace
}  // namespace bespoke
