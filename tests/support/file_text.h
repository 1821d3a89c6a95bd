#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace bespoke::test {

/// All bytes of a file; nothing when it cannot be read.
inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace bespoke::test
