#include "bespoke/mesh/detail/mesh_file_formats.h"

#include <string_view>
#include <vector>

#include "bespoke/mesh/detail/text_lines.h"

namespace bespoke {
namespace {

// "[ST][C][N]OFF"; true when every vertex has a normal.
bool read_header(TextLines& lines) {
  if (!lines.next_with_words()) lines.fail("the file has no content");
  std::string_view word = lines.word();
  const std::string whole(word);
  const auto skip = [&](std::string_view prefix) {
    const bool found = word.substr(0, prefix.size()) == prefix;
    if (found) word.remove_prefix(prefix.size());
    return found;
  };
  skip("ST");
  skip("C");
  const bool normals = skip("N");
  if (word != "OFF") lines.fail("an OFF file begins with OFF; other dimensions than three are not read");
  return normals;
}

}  // namespace

MeshFile check_off(const std::filesystem::path& path, const std::string& content) {
  TextLines lines(path, content);
  MeshFile file;
  file.normals = read_header(lines);
  TextLines after_keyword = lines;
  std::string_view word = after_keyword.word();
  if (word == "BINARY") lines.fail("binary OFF is not read; save as PLY");
  if (word.empty() && !lines.next_with_words()) lines.fail("missing number of vertices");
  const long long vertices = lines.integer("number of vertices");
  const long long faces = lines.integer("number of faces");
  if (!(vertices > 0)) lines.fail("the file has no vertices");
  if (!(faces >= 0)) lines.fail("a negative number of faces");
  file.content = "OFF\n" + std::to_string(vertices) + ' ' + std::to_string(faces) + " 0\n";
  for (long long vertex = 0; vertex < vertices; ++vertex) {
    if (!lines.next_with_words())
      lines.fail("the file ends after " + std::to_string(vertex) + " of " + std::to_string(vertices) +
                 " vertices");
    TextLines words = lines;
    for (const char* axis : {"x", "y", "z"}) {
      lines.number(axis);
      file.content += words.word();
      file.content += *axis == 'z' ? '\n' : ' ';
    }
  }
  for (long long face = 0; face < faces; ++face) {
    if (!lines.next_with_words())
      lines.fail("the file ends after " + std::to_string(face) + " of " + std::to_string(faces) + " faces");
    const long long corners = lines.integer("number of corners");
    std::vector<long long> polygon;
    for (long long i = 0; i < corners; ++i) polygon.push_back(lines.integer("corner"));
    const std::string fault = polygon_fault(polygon, 0, vertices);
    if (!fault.empty()) lines.fail(fault);
    file.content += std::to_string(corners);
    for (const long long vertex : polygon) file.content += ' ' + std::to_string(vertex);
    file.content += '\n';
  }
  file.vertices = static_cast<std::size_t>(vertices);
  file.polygons = static_cast<std::size_t>(faces);
  return file;
}

}  // namespace bespoke
