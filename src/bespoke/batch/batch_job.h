#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bespoke/progress.h"

namespace bespoke {

/// A file that a job reads or writes.
struct JobFile {
  std::string role;  ///< the option that names it, for instance "source"
  std::filesystem::path path;
};

/// A number or a word that a job found.
struct JobFigure {
  std::string name;
  std::variant<double, std::size_t, bool, std::string> value;
};

struct JobFindings {
  std::vector<JobFigure> figures;
  std::vector<std::string> warnings;                   ///< a sentence each
  std::vector<std::filesystem::path> further_outputs;  ///< that only the run could know
};

/// One run of a subcommand, ready to start.
struct BatchJob {
  std::size_t line = 0;  ///< of the manifest
  std::string command;   ///< for instance "fit"
  /// What shapes the outputs besides the inputs' content, by option; sorted.
  std::vector<std::pair<std::string, std::string>> options;
  std::vector<JobFile> inputs;
  std::vector<JobFile> outputs;
  std::optional<std::filesystem::path> shared_map;  ///< an input that jobs hold in memory together
  std::function<JobFindings(const Progress&)> run;
};

}  // namespace bespoke
