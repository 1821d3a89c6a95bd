#include "terminal_progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "interruption.h"

namespace bespoke::command {
namespace {

constexpr std::chrono::milliseconds bar_interval{100};
constexpr int bar_width = 30;

std::string duration(double seconds) {
  char text[32];
  const auto whole = static_cast<long>(seconds);
  if (seconds < 60)
    std::snprintf(text, sizeof text, "%.1f s", seconds);
  else
    std::snprintf(text, sizeof text, "%ld:%02ld min", whole / 60, whole % 60);
  return text;
}

std::string time_left(std::size_t done, std::size_t total, double seconds) {
  if (done == 0 || total == 0) return "";
  const double remaining = static_cast<double>(total - std::min(done, total)) / static_cast<double>(done);
  return ", " + duration(seconds * remaining) + " left";
}

int percent(std::size_t done, std::size_t total) {
  return static_cast<int>(100.0 * static_cast<double>(std::min(done, total)) / static_cast<double>(total));
}

}  // namespace

TerminalProgress::TerminalProgress(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

TerminalProgress::~TerminalProgress() {
  if (bar_open_) std::fputs("\r\033[K", stderr);
}

Progress TerminalProgress::progress() {
  Progress progress;
  progress.cancelled = [] { return interruption() != 0; };
  if (!quiet_)
    progress.report = [this](std::string_view stage, std::size_t done, std::size_t total) {
      show(stage, done, total);
    };
  return progress;
}

void TerminalProgress::show(std::string_view stage, std::size_t done, std::size_t total) {
  const Clock::time_point now = Clock::now();
  if (stage != stage_) {
    stage_ = stage;
    stage_start_ = now;
  }
  // Stages take turns (the bake certifies between its passes), so only the first start of each is news.
  const bool first = announced_.insert(stage_).second;
  if (!terminal_) {
    if (first) print_line();
    return;
  }
  const bool last = total > 0 && done >= total;
  if (!first && !last && now - last_shown_ < bar_interval) return;
  last_shown_ = now;
  draw_bar(done, total, std::chrono::duration<double>(now - stage_start_).count());
}

void TerminalProgress::draw_bar(std::size_t done, std::size_t total, double seconds) {
  std::string bar(bar_width, ' ');
  std::string share;
  if (total > 0) {
    const int filled = bar_width * percent(done, total) / 100;
    bar.replace(0, static_cast<std::size_t>(filled), static_cast<std::size_t>(filled), '#');
    share = std::to_string(percent(done, total)) + " %, ";
  }
  // \033[K clears what a longer line left behind.
  std::fprintf(stderr, "\r%-14s [%s] %s%s%s\033[K", stage_.c_str(), bar.c_str(), share.c_str(),
               duration(seconds).c_str(), time_left(done, total, seconds).c_str());
  std::fflush(stderr);
  bar_open_ = true;
}

void TerminalProgress::print_line() {
  const double seconds = std::chrono::duration<double>(stage_start_ - start_).count();
  std::fprintf(stderr, "%s: begins after %s\n", stage_.c_str(), duration(seconds).c_str());
}

}  // namespace bespoke::command
