#include "batch_display.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

#include "bespoke/pipeline/summary_json.h"
#include "terminal_progress.h"

namespace bespoke::command {
namespace {

constexpr std::chrono::milliseconds terminal_interval{100};
constexpr std::chrono::seconds openjd_interval{1};

/// Whole lines, at once: another program reads them.
void print_line(const std::string& line) {
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

}  // namespace

std::string place_in(const std::string& manifest, std::size_t line) {
  return line > 0 ? manifest + ":" + std::to_string(line) : manifest;
}

BatchDisplay::BatchDisplay(std::string manifest, const JobGraph& graph,
                           const std::vector<JobForecast>& forecasts, BatchStyle style,
                           const std::string& log)
    : manifest_(std::move(manifest)),
      graph_(graph),
      forecasts_(forecasts),
      style_(style),
      terminal_(isatty(STDERR_FILENO) == 1),
      progress_(forecasts) {
  if (!log.empty()) log_.emplace(log);
}

BatchDisplay::~BatchDisplay() {
  if (line_open_) std::fputs("\n", stderr);
}

std::string BatchDisplay::place(std::size_t job) const {
  return place_in(manifest_, graph_.jobs[job].line) + ": " + graph_.jobs[job].command;
}

void BatchDisplay::say(const std::string& line) {
  std::fprintf(stderr, "%s%s\n", line_open_ ? "\r\033[K" : "", line.c_str());
  line_open_ = false;
}

void BatchDisplay::started(std::size_t job) {
  progress_.started(job);
  if (style_ == BatchStyle::events)
    print_line(Json{{"event", "started"}, {"line", graph_.jobs[job].line}}.dump());
  show(false);
}

void BatchDisplay::ended(std::size_t job, const JobResult& result) {
  progress_.ended(job, result);
  if (log_ || style_ == BatchStyle::events) {
    const std::string json = job_json(graph_.jobs[job], forecasts_[job], result);
    if (log_) log_->append(json);
    if (style_ == BatchStyle::events) print_line("{\"event\":\"ended\"," + json.substr(1));
  }
  for (const std::string& warning : result.findings.warnings)
    say("bespoke: warning: " + place(job) + ": " + warning);
  if (result.state == JobState::failed) {
    say("bespoke: " + place(job) + ": " + result.error);
    if (style_ == BatchStyle::openjd) print_line("openjd_fail: " + place(job) + ": " + result.error);
  }
  show(false);
}

void BatchDisplay::show(bool last) {
  const Clock::time_point now = Clock::now();
  const Clock::duration interval = style_ == BatchStyle::openjd ? Clock::duration(openjd_interval)
                                   : terminal_                  ? Clock::duration(terminal_interval)
                                                                : Clock::duration(line_interval);
  if (!last && shown_ && now - *shown_ < interval) return;
  shown_ = now;
  if (style_ == BatchStyle::openjd) {
    char share[48];
    std::snprintf(share, sizeof share, "openjd_progress: %.1f", 100 * progress_.share());
    print_line(share);
    print_line("openjd_status: " + progress_.line());
  } else if (style_ == BatchStyle::line) {
    // \033[K clears what a longer line left behind.
    std::fprintf(stderr, terminal_ ? "\r%s\033[K" : "%s\n", progress_.line().c_str());
    std::fflush(stderr);
    line_open_ = terminal_;
  }
}

void BatchDisplay::close(const std::vector<JobResult>& results) {
  for (std::size_t job = 0; job < results.size(); ++job)
    if (log_ && results[job].state == JobState::not_run)
      log_->append(job_json(graph_.jobs[job], forecasts_[job], results[job]));
  show(true);
  if (style_ != BatchStyle::events) return;
  print_line(Json{{"event", "finished"},
                  {"done", progress_.count(JobState::done)},
                  {"up-to-date", progress_.count(JobState::up_to_date)},
                  {"failed", progress_.count(JobState::failed)},
                  {"not-run", progress_.left()}}
                 .dump());
}

}  // namespace bespoke::command
