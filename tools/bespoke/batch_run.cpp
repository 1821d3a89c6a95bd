#include "batch_run.h"

#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <cstdio>

#include "bespoke/error.h"
#include "bespoke/machine_memory.h"
#include "interruption.h"

namespace bespoke::command {
namespace {

/// Of the memory that is available, where nobody says how much the jobs may take: forecasts are off by some.
constexpr double default_memory_share = 0.75;

}  // namespace

BatchOptions batch_options(int threads) {
  BatchOptions options;
  options.threads = threads > 0 ? threads : tbb::info::default_concurrency();
  options.jobs = options.threads;
  options.max_memory =
      static_cast<std::size_t>(default_memory_share * static_cast<double>(available_memory()));
  options.stop = [] { return interruption() != 0; };
  return options;
}

void require_no_faults(const std::string& name, std::vector<ManifestFault> faults) {
  if (faults.empty()) return;
  std::stable_sort(faults.begin(), faults.end(),
                   [](const ManifestFault& a, const ManifestFault& b) { return a.line < b.line; });
  for (const ManifestFault& fault : faults)
    std::fprintf(stderr, "bespoke: %s: %s\n", place_in(name, fault.line).c_str(), fault.what.c_str());
  throw InvalidInput(name + ": " + std::to_string(faults.size()) +
                     (faults.size() == 1 ? " fault" : " faults") + "; nothing was run");
}

void run_jobs(const BatchShow& show, const JobGraph& graph, const std::vector<JobForecast>& forecasts,
              const BatchOptions& options, OpenedMaps& maps) {
  // Jobs bring threads of their own; this bounds what their loops take besides.
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(options.threads));
  BatchDisplay display(show.name, graph, forecasts, show.style, show.log);
  if (show.pages) show.pages->make_directory();
  const std::vector<JobResult> results =
      run_batch(graph, forecasts, options,
                {[&](std::size_t job) { display.started(job); },
                 [&](std::size_t job, const JobResult& result) { display.ended(job, result); },
                 [&](const std::filesystem::path& map) { maps.close(map); }});
  display.close(results);
  const BatchProgress& progress = display.progress();
  if (show.pages && (progress.count(JobState::done) > 0 || !show.pages->has_index()))
    show.pages->write_index();
  const std::string left = progress.left() > 0 ? ", " + std::to_string(progress.left()) + " did not run" : "";
  if (progress.count(JobState::failed) > 0)
    throw SolverError(std::to_string(progress.count(JobState::failed)) + " of " +
                      std::to_string(progress.total()) + " jobs failed" + left);
  if (progress.left() > 0) throw Interrupted("interrupted" + left);
}

}  // namespace bespoke::command
