#include "bespoke/thread_arena.h"

#include <tbb/task_arena.h>

namespace bespoke {

void run_on_threads(int threads, const std::function<void()>& body) {
  tbb::task_arena arena(threads);
  arena.execute(body);
}

}  // namespace bespoke
