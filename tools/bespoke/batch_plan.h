#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bespoke/batch/batch_job.h"
#include "bespoke/batch/manifest.h"
#include "bespoke/batch/opened_maps.h"
#include "html_pages.h"
#include "planned_run.h"

namespace bespoke::command {

/// Turns lines of a manifest into jobs, through the parsers of the subcommands: what is wrong with a line is
/// what the command line would say.
class JobPlanner {
 public:
  /// `maps` must outlive the jobs.
  explicit JobPlanner(OpenedMaps& maps) : maps_(maps) {}

  /// Throws InvalidInput, or the parser's error.
  BatchJob plan(const ManifestJob& line);

 private:
  struct Parser;

  Parser& parser_of(const std::string& command);
  BatchJob job_of(const ManifestJob& line, PlannedRun planned, const std::string& command) const;

  OpenedMaps& maps_;
  PlannedRun planned_;
  std::map<std::string, std::shared_ptr<Parser>> parsers_;
};

/// The jobs of a manifest that can be planned, and of `pages`, if any; the others become faults.
std::vector<BatchJob> plan_jobs(Manifest& manifest, OpenedMaps& maps, const HtmlPages* pages = nullptr);

}  // namespace bespoke::command
