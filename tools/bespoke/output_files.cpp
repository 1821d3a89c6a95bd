#include "output_files.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <system_error>

#include "bespoke/atomic_file.h"
#include "bespoke/error.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::equivalent(a, b, ignored) || fs::weakly_canonical(a) == fs::weakly_canonical(b);
}

}  // namespace

void require_safe_outputs(const std::vector<fs::path>& inputs, const std::vector<fs::path>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (const fs::path& input : inputs)
      if (same_file(input, outputs[i]))
        throw CLI::ValidationError(outputs[i].string(), "is an input of this run and would be overwritten");
    for (std::size_t j = 0; j < i; ++j)
      if (same_file(outputs[j], outputs[i]))
        throw CLI::ValidationError(outputs[i].string(),
                                   "would be written twice; give each output its own name");
    const fs::path directory = outputs[i].parent_path();
    if (!directory.empty() && !fs::is_directory(directory))
      throw FileError(outputs[i].string() + ": the directory " + directory.string() + " does not exist");
  }
}

void require_mesh_ending(const std::string& option, const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  constexpr std::array known{".obj", ".ply", ".stl", ".off"};
  if (std::find(known.begin(), known.end(), ending) == known.end())
    throw CLI::ValidationError(option, path.string() + " must end in .obj, .ply, .stl or .off");
}

OutputFiles::~OutputFiles() {
  std::error_code ignored;
  for (const fs::path& path : written_) fs::remove(path, ignored);
}

void OutputFiles::write(const fs::path& path, const std::function<void(const fs::path&)>& writer) {
  writer(path);
  written_.push_back(path);
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
