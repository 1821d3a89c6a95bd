#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "bespoke/batch/batch_report.h"
#include "bespoke/batch/line_log.h"

namespace bespoke::command {

enum class BatchStyle {
  line,    ///< one line that changes on a terminal, else one every ten seconds; failures and warnings
  quiet,   ///< failures and warnings alone
  events,  ///< one JSON object a line on standard output
  openjd,  ///< what Open Job Description's sessions read on standard output
};

/// What messages call a line of a manifest; 0: there is none, as of a run that the command line describes.
std::string place_in(const std::string& manifest, std::size_t line);

/// Shows on the terminal, or to a program, where a batch is, and writes its log. One thread at a time.
class BatchDisplay {
 public:
  BatchDisplay(std::string manifest, const JobGraph& graph, const std::vector<JobForecast>& forecasts,
               BatchStyle style, const std::string& log);
  ~BatchDisplay();
  BatchDisplay(const BatchDisplay&) = delete;
  BatchDisplay& operator=(const BatchDisplay&) = delete;

  void started(std::size_t job);
  void ended(std::size_t job, const JobResult& result);
  /// At the end: logs the jobs that never started, and shows the last line.
  void close(const std::vector<JobResult>& results);

  const BatchProgress& progress() const { return progress_; }

 private:
  using Clock = std::chrono::steady_clock;

  std::string place(std::size_t job) const;
  void say(const std::string& line);
  void show(bool last);

  std::string manifest_;
  const JobGraph& graph_;
  const std::vector<JobForecast>& forecasts_;
  BatchStyle style_;
  bool terminal_;
  bool line_open_ = false;
  BatchProgress progress_;
  std::optional<LineLog> log_;
  std::optional<Clock::time_point> shown_;
};

}  // namespace bespoke::command
