#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "bespoke/error.h"

namespace bespoke {

/// How a long stage tells its caller where it is, and learns that it should stop. Both callables may be
/// empty. `report` is called from the thread that runs the stage only; `cancelled` from any thread.
struct Progress {
  /// Stage name, work done and work in total (any unit; total 0 = unknown).
  std::function<void(std::string_view stage, std::size_t done, std::size_t total)> report;
  std::function<bool()> cancelled;

  void step(std::string_view stage, std::size_t done, std::size_t total) const {
    check();
    if (report) report(stage, done, total);
  }

  /// Throws Interrupted once the caller has requested a stop.
  void check() const {
    if (cancelled && cancelled()) throw Interrupted("interrupted");
  }
};

}  // namespace bespoke
