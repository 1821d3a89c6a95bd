#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/batch/batch_job.h"
#include "bespoke/batch/opened_maps.h"
#include "run_options.h"
#include "troubleshooting.h"

namespace bespoke::command {

/// What a run has of whoever started it: the command line, or a batch.
struct RunContext {
  const Progress& progress;
  OpenedMaps& maps;
  JobFindings& findings;
  /// Takes a whole warning: the command line prints it, a batch keeps it in its log.
  std::function<void(const std::string&)> take_warning;
  /// What a run without an output is for: printed, but not in a batch.
  std::function<void(const std::string&)> print;
  /// What does this run alone, for a person to type.
  std::string command;
  bool is_job = false;  ///< of a batch, which shares maps between its jobs

  /// One sentence that says what the user can do; the entry of the troubleshooting page is added.
  void warn(const std::string& warning, Entry entry) const { take_warning(with_entry(warning, entry)); }
};

/// A subcommand's arguments, checked as far as they can be without reading a file.
struct PlannedRun {
  RunOptions options;
  std::vector<JobFile> inputs;
  std::vector<JobFile> outputs;
  std::optional<std::filesystem::path> shared_map;  ///< an input that is opened through RunContext::maps
  std::function<void(const RunContext&)> run;       ///< may be called once
};

/// Takes a run that a subcommand has planned: starts it at once, or keeps it.
using PlanHandler = std::function<void(PlannedRun)>;

/// Starts it, with progress, warnings and results on the terminal.
void run_at_once(PlannedRun planned);

/// Those of the files that have a name.
std::vector<JobFile> named_files(std::vector<JobFile> files);

/// require_safe_outputs of what is planned.
void require_safe_outputs(const std::vector<JobFile>& inputs, const std::vector<JobFile>& outputs);

/// Writes the result of a subcommand to the file, or prints it where there is none.
void write_result(const std::string& output, const std::string& text, const RunContext& context);

}  // namespace bespoke::command
