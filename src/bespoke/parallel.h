#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace bespoke {

/// Calls body(begin, end) for consecutive ranges of at most `grain` indices that cover [0, count), on the
/// caller's TBB arena. The ranges are the same at any thread count. An exception of the body stops the loop
/// and reaches the caller.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Calls body() on the calling thread in an arena that no worker has entered or will enter: its parallel
/// loops, those inside third-party code included, run on this thread alone. A child forked inside the body
/// may therefore go on with it, although the workers of its parent are gone.
void run_alone(const std::function<void()>& body);

/// Reduces chunk results in the order of the chunks, so that the result has the same bits at any thread
/// count. `partial(begin, end)` returns a Result for one chunk of `grain` indices; `combine(a, b)` folds b
/// into a.
template <class Result, class Partial, class Combine>
Result parallel_reduce(std::size_t count, std::size_t grain, Result initial, const Partial& partial,
                       const Combine& combine) {
  std::vector<Result> results((count + grain - 1) / grain, initial);
  parallel_for(results.size(), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t chunk = first; chunk < last; ++chunk)
      results[chunk] = partial(chunk * grain, std::min(count, (chunk + 1) * grain));
  });
  for (const Result& result : results) initial = combine(initial, result);
  return initial;
}

}  // namespace bespoke
