#pragma once

#include <functional>

namespace bespoke {

/// Calls body() on the calling thread in an arena of its own, whose loops take up to `threads` (≥ 1) threads,
/// this one among them, out of those that the process has.
void run_on_threads(int threads, const std::function<void()>& body);

}  // namespace bespoke
