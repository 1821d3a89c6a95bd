#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace bespoke::command {

/// Refuses, before any work is done, what would fail or destroy something after it: an output that is also an
/// input, two outputs of one name (CLI::ValidationError), an output that is a directory, in one that does
/// not exist, or a stream that takes no output (FileError). An output "-" takes standard output for itself
/// (standard_output.h).
void require_safe_outputs(const std::vector<std::filesystem::path>& inputs,
                          const std::vector<std::filesystem::path>& outputs);

/// Refuses an ending that is not that of a format which faces are written in. Throws CLI::ValidationError.
void require_mesh_ending(const std::string& option, const std::filesystem::path& path);

/// Refuses an ending other than that of an asset, .vdb, by which other programs know it. Throws
/// CLI::ValidationError.
void require_map_ending(const std::filesystem::path& path);

/// The files that one run writes: all of them, or none.
class OutputFiles {
 public:
  OutputFiles() = default;
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;
  /// Removes what was written unless keep() was called.
  ~OutputFiles();

  void write(const std::filesystem::path& path,
             const std::function<void(const std::filesystem::path&)>& writer);
  /// Files that have been written.
  void add(const std::vector<std::filesystem::path>& paths);
  void write_text(const std::filesystem::path& path, const std::string& text);
  void keep() { written_.clear(); }

 private:
  std::vector<std::filesystem::path> written_;
};

}  // namespace bespoke::command
