#include "bespoke/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cassert>

#ifdef BESPOKE_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>

#include <chrono>
#include <thread>
#endif

namespace bespoke {
namespace {

// The thread sanitizer cannot see into TBB: these tell it that a loop's bodies run after what came before the
// loop and before what comes after it. Between bodies it sees no order, which is what it shall watch.
void happens_before([[maybe_unused]] void* event) {
#ifdef BESPOKE_THREAD_SANITIZER
  __tsan_release(event);
#endif
}

void happens_after([[maybe_unused]] void* event) {
#ifdef BESPOKE_THREAD_SANITIZER
  __tsan_acquire(event);
#endif
}

/// Says so when its scope ends, be it by an exception.
struct AtEnd {
  void (*say)(void*);
  void* event;
  ~AtEnd() { say(event); }
};

}  // namespace

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  assert(grain > 0);
  const std::size_t chunks = (count + grain - 1) / grain;
  char begun = 0, ended = 0;  // their addresses name the two events
  happens_before(&begun);
  const AtEnd all{happens_after, &ended};
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    happens_after(&begun);
    const AtEnd one{happens_before, &ended};
    body(chunk * grain, std::min(count, (chunk + 1) * grain));
  });
}

#ifdef BESPOKE_THREAD_SANITIZER
namespace {

// A report about a thread that OpenVDB has created counts as one of OpenVDB's own, which are suppressed: the
// workers are created here.
[[maybe_unused]] const bool has_workers = [] {
  parallel_for(16, 1,
               [](std::size_t, std::size_t) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
  return true;
}();

}  // namespace
#endif

void run_alone(const std::function<void()>& body) {
  tbb::task_arena arena(1);
  arena.execute(body);
}

}  // namespace bespoke
