#include "bespoke/product/off/off_text.h"

#include <string>

#include "bespoke/error.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

// "[ST][C][N][4][n]OFF", of which four and n dimensions are not read; the word may be left out.
bool read_keyword(TextWords& words, OffHeader& header) {
  TextWords ahead = words;
  std::string_view word = ahead.word();
  if (!word.empty() && word[0] >= '0' && word[0] <= '9' && word.find("OFF") == std::string_view::npos)
    return false;
  words.word();
  const auto skip = [&](std::string_view prefix) {
    const bool found = word.substr(0, prefix.size()) == prefix;
    if (found) word.remove_prefix(prefix.size());
    return found;
  };
  header.has_texture = skip("ST");
  skip("C");
  header.has_normals = skip("N");
  if (word != "OFF") words.fail("an OFF file begins with OFF; other dimensions than three are not read");
  TextWords behind = words;
  if (behind.word() == "BINARY") words.fail("binary OFF is not read; save as PLY");
  return true;
}

}  // namespace

OffHeader read_off_header(const InputFile& file) {
  const std::string head = text_head(file);
  TextBlock block;
  block.bytes = head;
  TextWords words(block, file.path());
  if (!words.next_line()) throw FormatError(file.path().string() + ": the file has no content");
  OffHeader header;
  if (read_keyword(words, header)) {
    TextWords ahead = words;
    if (ahead.word().empty() && !words.next_line()) words.fail("missing number of vertices");
  }
  TextWords counts = words;
  header.counts = static_cast<std::uint64_t>(counts.word().data() - head.data());
  const long long vertices = words.integer("number of vertices");
  const long long faces = words.integer("number of faces");
  if (!(vertices > 0)) words.fail("the file has no vertices");
  if (!(faces >= 0)) words.fail("a negative number of faces");
  header.vertices = static_cast<std::uint64_t>(vertices);
  header.faces = static_cast<std::uint64_t>(faces);
  header.size = static_cast<std::uint64_t>(words.line_end() - head.data());
  header.lines = count_line_breaks(std::string_view(head).substr(0, header.size));
  return header;
}

TextCutter OffText::cutter() const { return {path_, header_.lines + 1, line_counter({})}; }

TextRecords OffText::records(const TextBlock& block) const {
  TextRecords records;
  TextWords words(block, path_);
  for (std::uint64_t number = block.before[0]; words.next_line(); ++number) {
    if (number < header_.vertices) {
      records.points.push_back({words.number("x"), words.number("y"), words.number("z")});
      if (header_.has_normals)
        records.normals.push_back({words.number("nx"), words.number("ny"), words.number("nz")});
    } else if (number - header_.vertices < header_.faces) {
      read_face(words, records);
    } else {
      words.fail("a line behind the last face");
    }
  }
  return records;
}

void OffText::require_complete(const std::array<std::uint64_t, 3>& sums) const {
  if (sums[0] == header_.vertices + header_.faces) return;
  const bool in_vertices = sums[0] < header_.vertices;
  throw FormatError(path_.string() + ": the file ends after " +
                    std::to_string(in_vertices ? sums[0] : sums[0] - header_.vertices) + " of " +
                    std::to_string(in_vertices ? header_.vertices : header_.faces) +
                    (in_vertices ? " vertices" : " faces"));
}

void OffText::read_face(TextWords& words, TextRecords& records) const {
  const long long corners = words.integer("number of corners");
  if (corners < 1) words.fail("a face of " + std::to_string(corners) + " corners");
  records.faces.push_back(static_cast<std::uint32_t>(corners));
  for (long long i = 0; i < corners; ++i) {
    const long long vertex = words.integer("corner");
    if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= header_.vertices)
      words.fail("a face names vertex " + std::to_string(vertex) + ", outside 0 … " +
                 std::to_string(header_.vertices - 1));
    records.faces.push_back(static_cast<std::uint32_t>(vertex));
  }
}

}  // namespace bespoke
