#pragma once

#include <chrono>

namespace bespoke {

/// Wall-clock seconds, for summaries; never part of an asset.
class Stopwatch {
 public:
  /// Since it was made.
  double seconds() const { return between(start_, Clock::now()); }

  /// Since the last call, or since it was made.
  double lap() {
    const Clock::time_point now = Clock::now();
    const double seconds = between(lap_, now);
    lap_ = now;
    return seconds;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double between(Clock::time_point begin, Clock::time_point end) {
    return std::chrono::duration<double>(end - begin).count();
  }

  Clock::time_point start_ = Clock::now();
  Clock::time_point lap_ = start_;
};

}  // namespace bespoke
