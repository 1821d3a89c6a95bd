#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace bespoke {

/// One option of a job as the command line would take it: a flag that is on has the value "true", one that is
/// off none; several values are those of an option that may be repeated.
struct ManifestEntry {
  std::string key;
  std::vector<std::string> values;
  bool flag = false;  ///< stands without a value where it is on
};

/// One line of a manifest.
struct ManifestJob {
  std::size_t line = 0;  ///< from 1
  std::string command;   ///< for instance "fit"
  std::vector<ManifestEntry> entries;
};

/// What is wrong with a line of a manifest, for a person.
struct ManifestFault {
  std::size_t line = 0;
  std::string what;
};

struct Manifest {
  std::vector<ManifestJob> jobs;
  std::vector<ManifestFault> faults;  ///< lines that are no jobs
};

/// Reads a manifest: by the ending .csv a table whose header names the keys (a cell without text leaves its
/// key out, "true" and "false" are flags), else one JSON object a line, whose values are texts, numbers,
/// flags or lists of texts and numbers. The key "command" is in both. Blank lines count but are no jobs.
/// Throws FileError when the file cannot be read.
Manifest read_manifest(const std::filesystem::path& path);

/// Reads a table as a .csv manifest, with `key` in the place of "command".
Manifest read_table(const std::filesystem::path& path, const std::string& key);

}  // namespace bespoke
