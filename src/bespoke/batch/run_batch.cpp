#include "bespoke/batch/run_batch.h"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <tuple>
#include <utility>

#include "bespoke/atomic_file.h"
#include "bespoke/batch/job_records.h"
#include "bespoke/error.h"
#include "bespoke/report/report.h"
#include "bespoke/stopwatch.h"
#include "bespoke/thread_arena.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

/// Of a job's forecast seconds; what a shorter one takes is lost among what the process holds anyway.
constexpr double min_seconds_to_measure_memory = 0.5;

/// From now on peak_memory counts anew. Where Linux does not allow it, the figure is that of the process.
void reset_peak_memory() { std::ofstream("/proc/self/clear_refs") << "5"; }

/// A map that jobs share, while there are any left.
struct SharedMap {
  std::size_t bytes = 0;
  std::size_t users_left = 0;
  std::size_t users_running = 0;
  bool held = false;
};

/// Seconds of the longest way from the start of each job to the end of the last that waits for it.
std::vector<double> seconds_to_the_end(const JobGraph& graph, const std::vector<JobForecast>& forecasts) {
  std::vector<double> seconds(graph.jobs.size(), 0);
  std::vector<std::size_t> waits(graph.jobs.size()), last;
  for (std::size_t i = 0; i < waits.size(); ++i)
    if ((waits[i] = graph.feeds[i].size()) == 0) last.push_back(i);
  while (!last.empty()) {
    const std::size_t job = last.back();
    last.pop_back();
    seconds[job] += forecasts[job].seconds;
    for (const std::size_t need : graph.needs[job]) {
      seconds[need] = std::max(seconds[need], seconds[job]);
      if (--waits[need] == 0) last.push_back(need);
    }
  }
  return seconds;
}

class Scheduler {
 public:
  Scheduler(const JobGraph& graph, const std::vector<JobForecast>& forecasts, const BatchOptions& options,
            const BatchEvents& events)
      : graph_(graph),
        forecasts_(forecasts),
        options_(options),
        events_(events),
        results_(graph.jobs.size()) {
    const std::vector<double> urgency = seconds_to_the_end(graph, forecasts);
    std::map<fs::path, std::size_t> first_user;
    for (std::size_t i = 0; i < graph.jobs.size(); ++i) {
      std::size_t group = i;
      if (const auto& map = graph.jobs[i].shared_map) {
        group = first_user.try_emplace(*map, i).first->second;
        SharedMap& shared = shared_[*map];
        shared.bytes = std::max(shared.bytes, forecasts[i].shared);
        ++shared.users_left;
      }
      // Jobs of about the same urgency, by powers of two, keep their order, so that a map is not needed long.
      order_.emplace_back(-std::ilogb(urgency[i] + 1e-9), group, i);
      waits_.push_back(graph.needs[i].size());
      if (waits_.back() == 0) unchecked_.push_back(i);
      seconds_left_ += forecasts[i].seconds;
    }
  }

  std::vector<JobResult> run() {
    std::vector<std::thread> others;
    for (int i = 1; i < options_.jobs; ++i) others.emplace_back([this] { work(); });
    work();
    for (std::thread& other : others) other.join();
    directories_.flush();
    return std::move(results_);
  }

 private:
  using Lock = std::unique_lock<std::mutex>;
  using Order = std::tuple<int, std::size_t, std::size_t>;  // urgency, group, job

  void work() {
    Lock lock(mutex_);
    for (;;) {
      if (is_stopped()) {
        unchecked_.clear();
        ready_.clear();
      }
      if (!unchecked_.empty()) {
        check_next(lock);
      } else if (const std::optional<std::size_t> job = admitted()) {
        run_job(*job, lock);
      } else if (busy_ == 0) {
        changed_.notify_all();
        return;
      } else {
        changed_.wait(lock);
      }
    }
  }

  bool is_stopped() { return stopped_ = stopped_ || (options_.stop && options_.stop()); }

  void check_next(Lock& lock) {
    const std::size_t job = unchecked_.front();
    unchecked_.pop_front();
    ++busy_;
    lock.unlock();
    JobResult result;
    try {
      const BatchJob& checked = graph_.jobs[job];
      result.reason =
          goes_into_archive(job) ? options_.pack->reason_to_run(checked) : records_.reason_to_run(checked);
      if (result.reason.empty()) result.state = JobState::up_to_date;
    } catch (const std::exception& error) {
      fail(result, error);
    }
    lock.lock();
    --busy_;
    results_[job].reason = result.reason;
    if (result.state == JobState::not_run) {
      ready_.insert(order_[job]);
      changed_.notify_one();
    } else {
      seconds_left_ -= forecasts_[job].seconds;
      end(job, std::move(result));
    }
  }

  /// The first job whose memory fits; any where nothing runs.
  std::optional<std::size_t> admitted() {
    for (const auto& [urgency, group, job] : ready_)
      if (memory_ + memory_of(job) <= options_.max_memory) return job;
    if (running_ > 0 || ready_.empty()) return std::nullopt;
    close_idle_maps();
    return std::get<2>(*ready_.begin());
  }

  std::size_t memory_of(std::size_t job) const {
    const auto& map = graph_.jobs[job].shared_map;
    const bool opens = map && !shared_.at(*map).held;
    return forecasts_[job].memory + (opens ? shared_.at(*map).bytes : 0);
  }

  /// A share of the threads as large as that of the work that is left.
  int threads_of(std::size_t job) const {
    const double share = forecasts_[job].seconds / std::max(seconds_left_, forecasts_[job].seconds);
    const int wanted =
        std::max(options_.threads / options_.jobs, static_cast<int>(std::lround(options_.threads * share)));
    return std::clamp(wanted, 1, std::max(1, options_.threads - threads_));
  }

  void run_job(std::size_t job, Lock& lock) {
    ready_.erase(order_[job]);
    JobResult result;
    result.reason = results_[job].reason;
    result.threads = threads_of(job);
    const std::size_t own_memory = forecasts_[job].memory;
    memory_ += memory_of(job);
    if (const auto& map = graph_.jobs[job].shared_map) {
      shared_[*map].held = true;
      ++shared_[*map].users_running;
    }
    threads_ += result.threads;
    seconds_left_ -= forecasts_[job].seconds;
    if (running_++ == 0 && forecasts_[job].seconds > min_seconds_to_measure_memory) reset_peak_memory();
    ++busy_;
    if (events_.started) events_.started(job);
    lock.unlock();
    carry_out(job, result);
    lock.lock();
    --busy_;
    --running_;
    threads_ -= result.threads;
    memory_ -= own_memory;
    if (const auto& map = graph_.jobs[job].shared_map) --shared_[*map].users_running;
    end(job, std::move(result));
  }

  bool goes_into_archive(std::size_t job) const { return options_.pack && is_packed(graph_, job); }

  void carry_out(std::size_t job, JobResult& result) {
    const Stopwatch watch;
    try {
      goes_into_archive(job) ? run_into_archive(graph_.jobs[job], result)
                             : run_in_place(graph_.jobs[job], result);
      result.state = JobState::done;
    } catch (const std::exception& error) {
      fail(result, error);
    }
    result.seconds = watch.seconds();
    result.memory = peak_memory();
  }

  void run_in_place(const BatchJob& job, JobResult& result) {
    for (const JobFile& output : job.outputs)
      if (output.path.has_parent_path()) make_directories(output.path.parent_path());
    const std::vector<RecordedFile> inputs = records_.inputs_of(job);
    run_on_threads(result.threads, [&] { directories_.note([&] { result.findings = job.run({}); }); });
    records_.write(job, inputs, result.findings);
  }

  void run_into_archive(const BatchJob& job, JobResult& result) {
    const std::vector<RecordedFile> inputs = options_.pack->inputs_of(job);
    HeldFiles outputs(fs::temp_directory_path());
    run_on_threads(result.threads, [&] { outputs.hold([&] { result.findings = job.run({}); }); });
    options_.pack->write(job, inputs, outputs);
  }

  static void fail(JobResult& result, const std::exception& error) {
    result.state = JobState::failed;
    result.error = error.what();
    result.cause = std::current_exception();
  }

  void end(std::size_t job, JobResult result) {
    const bool failed = result.state == JobState::failed;
    if (failed && !options_.keep_going) stopped_ = true;
    if (!failed)
      for (const std::size_t fed : graph_.feeds[job])
        if (--waits_[fed] == 0) unchecked_.push_back(fed);
    if (const auto& map = graph_.jobs[job].shared_map)
      if (--shared_[*map].users_left == 0) close(*map);
    results_[job] = std::move(result);
    if (events_.ended) events_.ended(job, results_[job]);
    changed_.notify_all();
  }

  void close(const fs::path& map) {
    SharedMap& shared = shared_[map];
    if (!shared.held) return;
    shared.held = false;
    memory_ -= shared.bytes;
    if (events_.close_map) events_.close_map(map);
  }

  void close_idle_maps() {
    for (const auto& [map, shared] : shared_)
      if (shared.users_running == 0) close(map);
  }

  const JobGraph& graph_;
  const std::vector<JobForecast>& forecasts_;
  const BatchOptions& options_;
  const BatchEvents& events_;
  JobRecords records_;
  // Flushed for each job, a directory costs as much as the job's own file. A name that a power failure takes
  // away is missing, and its job runs again.
  LateDirectories directories_;

  std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  std::vector<JobResult> results_;
  std::vector<Order> order_;
  std::vector<std::size_t> waits_;
  std::deque<std::size_t> unchecked_;  // what they need is done
  std::set<Order> ready_;              // not up to date
  std::map<fs::path, SharedMap> shared_;
  std::size_t memory_ = 0;  // bytes, forecast of what runs and of the maps that are held
  double seconds_left_ = 0;
  int threads_ = 0;  // in use
  int running_ = 0;
  int busy_ = 0;  // running or being checked
  bool stopped_ = false;
};

}  // namespace

std::vector<JobResult> run_batch(const JobGraph& graph, const std::vector<JobForecast>& forecasts,
                                 const BatchOptions& options, const BatchEvents& events) {
  if (!graph.faults.empty()) throw InvalidInput("a batch with faults in its manifest cannot run");
  std::vector<JobResult> results = Scheduler(graph, forecasts, options, events).run();
  if (options.pack) options.pack->finish();
  return results;
}

}  // namespace bespoke
