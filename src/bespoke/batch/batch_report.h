#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/batch/run_batch.h"
#include "bespoke/stopwatch.h"

namespace bespoke {

/// "done", "up-to-date", "failed", "not-run".
const char* to_string(JobState state);

/// What is known of a job at its end, as one JSON object without its line's end: line, command, outputs,
/// state, seconds, threads, memory and what was forecast of them, warnings, error, figures.
std::string job_json(const BatchJob& job, const JobForecast& forecast, const JobResult& result);

/// How far a batch is.
class BatchProgress {
 public:
  BatchProgress(const std::vector<JobForecast>& forecasts);

  void started(std::size_t job);
  void ended(std::size_t job, const JobResult& result);

  std::size_t count(JobState state) const;
  std::size_t running() const { return running_; }
  std::size_t total() const { return forecasts_.size(); }
  std::size_t left() const { return total() - ended_ - running_; }
  /// By forecast seconds, from 0 to 1.
  double share() const;
  /// Jobs that ran, a second.
  double rate() const;
  /// Seconds: as long for the forecast that is left as it took for what ran; 0 while nothing has.
  double seconds_left() const;

  /// "12 of 40 done, 3 up to date, 1 failed, 2 running, 22 left, 1.5/s, 0:14 left".
  std::string line() const;

 private:
  std::vector<JobForecast> forecasts_;
  Stopwatch watch_;
  std::size_t counts_[4] = {};
  std::size_t running_ = 0;
  std::size_t ended_ = 0;
  double seconds_ended_ = 0;  // forecast, of all that ended
  double seconds_run_ = 0;    // forecast, of those that ran
  double seconds_total_ = 0;
};

}  // namespace bespoke
