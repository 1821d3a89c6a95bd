#include "bespoke/mesh/detail/mesh_file_formats.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "bespoke/mesh/detail/text_lines.h"

namespace bespoke {
namespace {

static_assert(sizeof(float) == 4);
constexpr std::size_t header_size = 84, facet_size = 50;

std::string lower(std::string_view word) {
  std::string result(word);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

MeshFile check_ascii(const std::filesystem::path& path, const std::string& content) {
  TextLines lines(path, content);
  MeshFile file;
  file.content = "solid\n";
  int corners = -1;  // -1 outside of a loop
  while (lines.next_with_words()) {
    const std::string keyword = lower(lines.word());
    if (keyword == "outer") {
      if (corners >= 0) lines.fail("a loop inside of a loop");
      corners = 0;
      file.content += "facet normal 0 0 0\nouter loop\n";
    } else if (keyword == "vertex") {
      if (corners < 0 || corners > 2) lines.fail("a vertex that is none of the three of a loop");
      TextLines words = lines;
      file.content += "vertex";
      for (const char* axis : {"x", "y", "z"}) {
        lines.number(axis);
        file.content += ' ';
        file.content += words.word();
      }
      file.content += '\n';
      ++corners;
    } else if (keyword == "endloop") {
      if (corners != 3) lines.fail("a loop of " + std::to_string(std::max(corners, 0)) + " vertices");
      corners = -1;
      file.content += "endloop\nendfacet\n";
      ++file.polygons;
    } else if (keyword != "facet" && keyword != "endfacet" && keyword != "solid" && keyword != "endsolid") {
      lines.fail("unknown word at the beginning of the line");
    }
  }
  if (corners >= 0) lines.fail("the file ends inside of a loop");
  if (file.polygons == 0) throw FormatError(path.string() + ": the file has no facets");
  file.content += "endsolid\n";
  return file;
}

MeshFile check_binary(const std::filesystem::path& path, const std::string& content, std::size_t facets) {
  if (facets == 0) throw FormatError(path.string() + ": the file has no facets");
  MeshFile file;
  file.content = content;
  file.binary = true;
  file.polygons = facets;
  for (std::size_t facet = 0; facet < facets; ++facet) {
    float corners[9];
    std::memcpy(corners, content.data() + header_size + facet * facet_size + 12, sizeof corners);
    for (const float value : corners)
      if (!std::isfinite(value))
        throw FormatError(path.string() + ": facet " + std::to_string(facet) +
                          " has a coordinate that is not finite");
  }
  return file;
}

}  // namespace

// Binary files that begin with "solid" exist, so the size decides.
MeshFile check_stl(const std::filesystem::path& path, const std::string& content) {
  std::uint32_t facets = 0;
  if (content.size() >= header_size) std::memcpy(&facets, content.data() + 80, sizeof facets);
  const std::size_t binary_size = header_size + facets * facet_size;
  if (content.size() == binary_size) return check_binary(path, content, facets);
  TextLines first(path, content);
  if (first.next_with_words() && lower(first.word()) == "solid") return check_ascii(path, content);
  if (content.size() < header_size)
    throw FormatError(path.string() +
                      ": neither text that begins with \"solid\" nor as long as a binary STL file's header");
  throw FormatError(path.string() + ": a binary STL file of " + std::to_string(facets) + " facets has " +
                    std::to_string(binary_size) + " bytes, this one has " + std::to_string(content.size()));
}

}  // namespace bespoke
