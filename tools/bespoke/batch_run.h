#pragma once

#include <string>
#include <vector>

#include "batch_display.h"
#include "bespoke/batch/opened_maps.h"
#include "bespoke/batch/run_batch.h"
#include "html_pages.h"

namespace bespoke::command {

/// Who starts the jobs, and how their progress is shown.
struct BatchShow {
  std::string name;  ///< of the manifest, for messages
  BatchStyle style = BatchStyle::line;
  std::string log;                   ///< empty: none
  const HtmlPages* pages = nullptr;  ///< of the jobs, if any
};

/// Threads (0: as many as the machine has), as many jobs at a time, three quarters of the memory that is
/// available, and signals stop between two jobs.
BatchOptions batch_options(int threads);

/// Prints every fault and throws InvalidInput when there are any: nothing has run.
void require_no_faults(const std::string& name, std::vector<ManifestFault> faults);

/// Runs the jobs and shows how far they are; then the pages, if any, get their index, unless nothing has
/// changed. Throws SolverError when some failed, Interrupted when some did not start.
void run_jobs(const BatchShow& show, const JobGraph& graph, const std::vector<JobForecast>& forecasts,
              const BatchOptions& options, OpenedMaps& maps);

}  // namespace bespoke::command
