#include "bespoke/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cassert>

namespace bespoke {

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  assert(grain > 0);
  const std::size_t chunks = (count + grain - 1) / grain;
  tbb::parallel_for(std::size_t{0}, chunks,
                    [&](std::size_t chunk) { body(chunk * grain, std::min(count, (chunk + 1) * grain)); });
}

void run_alone(const std::function<void()>& body) {
  tbb::task_arena arena(1);
  arena.execute(body);
}

}  // namespace bespoke
