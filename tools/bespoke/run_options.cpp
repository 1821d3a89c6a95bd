#include "run_options.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include "help.h"
#include "terminal_progress.h"

namespace bespoke::command {

void add_run_options(CLI::App& app, RunOptions& options) {
  begin_group(app, output_group);
  app.add_flag("-q,--quiet", options.quiet,
               "No progress and no summary; results, errors and warnings are still printed");
  begin_group(app, jobs_group);
  app.add_option("--threads", options.threads,
                 "Threads to use (default: one a core); results do not depend on it")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
}

void run_with(const RunOptions& options, const std::function<void(const Progress&)>& body) {
  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  // The limit bounds the workers of the whole process; the arena lets more threads than cores take part.
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute([&] {
    TerminalProgress terminal(options.quiet);
    body(terminal.progress());
  });
}

}  // namespace bespoke::command
