#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/batch/batch_job.h"

namespace bespoke::command {

/// How a map is found in a catalogue instead of being named.
struct CatalogOption {
  std::string directory;  ///< empty: the map is named
  std::string source, source_hash;
  std::string target, target_hash;

  bool is_used() const { return !directory.empty(); }
};

/// --from, --source, --source-hash, --target, --target-hash.
void add_catalog_option(CLI::App& app, CatalogOption& option);

/// Refuses options that do not go together. Throws CLI::ValidationError.
void require_valid(const CatalogOption& option);

/// The files that tell which map it is.
std::vector<JobFile> inputs(const CatalogOption& option);

/// The map's file. Throws whatever reading throws; InvalidInput when there is not one map; FormatError when
/// its file is not the one that was indexed.
std::filesystem::path find_map(const CatalogOption& option);

}  // namespace bespoke::command
