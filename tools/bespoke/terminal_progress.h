#pragma once

#include <chrono>
#include <set>
#include <string>

#include "bespoke/progress.h"

namespace bespoke::command {

/// Between lines of a batch's progress where there is no terminal.
inline constexpr std::chrono::seconds line_interval{10};

/// Shows on standard error where a long run is: a bar with the time left when that is a terminal,
/// else one line a stage, when it first begins. Also what makes an interruption reach
/// the library. One thread.
class TerminalProgress {
 public:
  explicit TerminalProgress(bool quiet);
  ~TerminalProgress();
  TerminalProgress(const TerminalProgress&) = delete;
  TerminalProgress& operator=(const TerminalProgress&) = delete;

  /// Refers to this object.
  Progress progress();

 private:
  using Clock = std::chrono::steady_clock;

  void show(std::string_view stage, std::size_t done, std::size_t total);
  void draw_bar(std::size_t done, std::size_t total, double seconds);
  void print_line();

  bool quiet_;
  bool terminal_;
  bool bar_open_ = false;
  std::string stage_;
  std::set<std::string> announced_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point stage_start_;
  Clock::time_point last_shown_;
};

}  // namespace bespoke::command
