#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "bespoke/batch/forecast.h"
#include "bespoke/batch/job_graph.h"
#include "bespoke/batch/packed_jobs.h"

namespace bespoke {

enum class JobState {
  done,
  up_to_date,  ///< its outputs are those of its inputs already
  failed,
  not_run,  ///< the batch stopped before, or a job failed whose output it reads
};

struct JobResult {
  JobState state = JobState::not_run;
  std::string reason;        ///< why it ran
  std::string error;         ///< of one that failed
  std::exception_ptr cause;  ///< the same
  double seconds = 0;
  int threads = 0;
  /// Largest resident memory of the process while the job ran, bytes: with that of the jobs beside it and,
  /// where it is short, before it.
  std::size_t memory = 0;
  JobFindings findings;
};

struct BatchOptions {
  int threads = 1;             ///< of all jobs together
  int jobs = 1;                ///< most at a time
  std::size_t max_memory = 0;  ///< bytes that the forecasts of running jobs may add up to
  bool keep_going = false;     ///< after a job has failed, all others that do not need it
  std::function<bool()> stop;  ///< called before a job starts: those that run end, no more start
  /// Open for writing: takes the outputs that no job reads, and is finished at the end.
  PackedJobs* pack = nullptr;
};

/// Notifications while a batch runs, never two at a time. May be empty.
struct BatchEvents {
  std::function<void(std::size_t job)> started;
  std::function<void(std::size_t job, const JobResult& result)> ended;  ///< also of jobs up to date
  std::function<void(const std::filesystem::path& map)> close_map;      ///< no job needs it any more
};

/// Runs jobs of a graph without faults, each once those that it needs are done and its forecast memory fits,
/// unless its record is up to date. Mostly one thread a job; jobs that lead to the most work start first,
/// those of one map together. Outputs do not depend on any of this; their directories are made. Returns one
/// result a job; a job that throws is a result. Throws FileError when the archive cannot be finished.
std::vector<JobResult> run_batch(const JobGraph& graph, const std::vector<JobForecast>& forecasts,
                                 const BatchOptions& options, const BatchEvents& events = {});

}  // namespace bespoke
