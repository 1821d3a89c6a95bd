#include "output_files.h"

#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>

#include "bespoke/atomic_file.h"
#include "bespoke/error.h"
#include "bespoke/output_stream.h"
#include "bespoke/product/product_io.h"
#include "bespoke/unknown_ending.h"
#include "standard_output.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

/// Of a file that is there, by the system's numbers.
std::optional<std::string> number_of(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
}

/// The same for every name of a file, whether it is there already or not.
std::string identity(const fs::path& path) {
  if (is_standard_output(path)) return path.string();
  if (const std::optional<std::string> number = number_of(path)) return *number;
  const std::optional<std::string> directory = number_of(path.has_parent_path() ? path.parent_path() : ".");
  return directory ? *directory + "/" + path.filename().string() : fs::weakly_canonical(path).string();
}

}  // namespace

void require_safe_outputs(const std::vector<fs::path>& inputs, const std::vector<fs::path>& outputs) {
  std::set<std::string> read, written;
  for (const fs::path& input : inputs) read.insert(identity(input));
  for (const fs::path& output : outputs) {
    // What a device is given is not there to be read or lost.
    if (fs::is_character_file(output)) continue;
    const std::string own = identity(output);
    if (read.count(own) > 0)
      throw CLI::ValidationError(output.string(), "is an input of this run and would be overwritten");
    if (!written.insert(own).second)
      throw CLI::ValidationError(output.string(), "would be written twice; give each output its own name");
    if (writes_are_held()) continue;
    if (is_standard_output(output)) {
      reserve_standard_output();
      continue;
    }
    if (is_stream(output)) {
      require_writable_stream(output);
      continue;
    }
    if (fs::is_directory(output))
      throw FileError(output.string() + ": is a directory; give the output the name of a file");
    const fs::path directory = output.parent_path();
    if (!directory.empty() && !fs::is_directory(directory))
      throw FileError(output.string() + ": the directory " + directory.string() + " does not exist");
  }
}

void require_mesh_ending(const std::string& option, const fs::path& path) {
  if (!can_write_product(path))
    throw UnknownEnding(option + ": " + path.string() + " must end in " + written_product_endings());
}

void require_map_ending(const fs::path& path) {
  if (path.extension() != ".vdb") throw UnknownEnding("--output: " + path.string() + " must end in .vdb");
}

OutputFiles::~OutputFiles() {
  for (const fs::path& path : written_) remove_written(path);
}

void OutputFiles::write(const fs::path& path, const std::function<void(const fs::path&)>& writer) {
  const fs::path target = output_target(path);
  writer(target);
  written_.push_back(target);
}

void OutputFiles::add(const std::vector<fs::path>& paths) {
  std::copy_if(paths.begin(), paths.end(), std::back_inserter(written_),
               [](const fs::path& path) { return !is_standard_output(path); });
}

void OutputFiles::write_text(const fs::path& path, const std::string& text) {
  write(path, [&](const fs::path& target) {
    write_atomically(target, [&](const fs::path& temporary) {
      std::ofstream file(temporary, std::ios::binary);
      file << text;
      file.close();
      if (!file) throw FileError(target.string() + ": cannot be written");
    });
  });
}

}  // namespace bespoke::command
