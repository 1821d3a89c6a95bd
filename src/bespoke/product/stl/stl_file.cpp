#include "bespoke/product/stl/stl_file.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "bespoke/error.h"
#include "bespoke/strings.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

constexpr std::size_t facets_a_block = std::size_t{1} << 14;

/// The first word of a line, in lower case.
std::string first_word(std::string_view line) {
  line = without_byte_order_mark(line);
  const std::size_t begin = std::min(line.find_first_not_of(" \t\r"), line.size());
  return lower_case(line.substr(begin, line.find_first_of(" \t\r\n", begin) - begin));
}

/// How many solids begin and end.
void count_solids(std::string_view lines, std::array<std::uint64_t, 3>& sums) {
  TextBlock block;
  block.bytes = lines;
  const std::filesystem::path unnamed;
  TextWords words(block, unnamed, {0, false});
  while (words.next_line()) {
    if (std::string_view("sSeE").find(*words.line_begin()) == std::string_view::npos) continue;
    const std::string keyword = lower_case(words.word());
    sums[0] += keyword == "solid";
    sums[1] += keyword == "endsolid";
  }
}

void expect(TextWords& words, const char* keyword, bool on_new_line = true) {
  if (on_new_line && !words.next_line())
    words.fail(std::string("the file ends before the facet's ") + keyword);
  const std::string_view word = words.word();
  if (lower_case(word) != keyword) words.fail(in_quotes(word) + " where " + keyword + " must stand");
}

}  // namespace

// Binary files that begin with "solid" exist, so the size decides.
std::optional<std::size_t> binary_stl_facets(const InputFile& file) {
  const std::string head = file_head(file);
  const std::string path = file.path().string();
  std::uint32_t facets = 0;
  if (head.size() >= stl_header_size) std::memcpy(&facets, head.data() + 80, sizeof facets);
  const std::uint64_t binary_size = stl_header_size + std::uint64_t{facets} * stl_facet_size;
  if (file.size() == binary_size) {
    if (facets == 0) throw FormatError(path + ": the file has no facets");
    return facets;
  }
  require_utf8(head, file.path());
  if (first_word(head.substr(0, head.find_first_of("\r\n"))) == "solid") return std::nullopt;
  if (head.size() < stl_header_size)
    throw FormatError(path +
                      ": neither text that begins with \"solid\" nor as long as a binary STL file's header");
  throw FormatError(path + ": a binary STL file of " + std::to_string(facets) + " facets has " +
                    std::to_string(binary_size) + " bytes, this one has " + std::to_string(file.size()));
}

std::vector<FacetBlock> FacetCutter::operator()(const Window& window) {
  std::vector<FacetBlock> blocks;
  std::string_view rest = window.bytes;
  while (rest.size() >= stl_facet_size) {
    const std::size_t count = std::min(rest.size() / stl_facet_size, facets_a_block);
    blocks.push_back({rest.substr(0, count * stl_facet_size), done_});
    rest.remove_prefix(count * stl_facet_size);
    done_ += count;
  }
  return blocks;
}

Points facet_points(const FacetBlock& block, const InputFile& file, std::size_t facets) {
  const std::size_t count = block.bytes.size() / stl_facet_size;
  Points points(3, static_cast<Eigen::Index>(4 * count));
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Matrix<float, 3, 4> stored;
    std::memcpy(stored.data(), block.bytes.data() + i * stl_facet_size, sizeof(float) * 12);
    if (!stored.rightCols<3>().allFinite())
      throw FormatError(file.path().string() + ": facet " + std::to_string(block.first + i) + " of " +
                        std::to_string(facets) + " has a coordinate that is not finite");
    points.middleCols<4>(static_cast<Eigen::Index>(4 * i)) = stored.cast<double>();
  }
  return points;
}

TextCutter StlText::cutter() const {
  return {path_, 1, count_solids, [](std::string_view line) { return first_word(line) == "endfacet"; }};
}

TextRecords StlText::records(const TextBlock& block) const {
  TextRecords records;
  TextWords words(block, path_, {0, false});
  bool is_inside = block.before[0] > block.before[1];
  while (words.next_line()) {
    const std::string keyword = lower_case(words.word());
    if (keyword == "solid" && !is_inside) {
      is_inside = true;
    } else if (keyword == "endsolid" && is_inside) {
      is_inside = false;
    } else if (keyword == "facet" && is_inside) {
      read_facet(words, records);
    } else {
      words.fail("the word " + in_quotes(keyword) + " in a wrong place");
    }
  }
  return records;
}

void StlText::require_complete(const std::array<std::uint64_t, 3>& sums) const {
  if (sums[0] != sums[1]) throw FormatError(path_.string() + ": the file ends before endsolid");
}

void StlText::read_facet(TextWords& words, TextRecords& records) const {
  expect(words, "normal", false);
  if (with_normals_) records.normals.push_back({words.number("nx"), words.number("ny"), words.number("nz")});
  expect(words, "outer");
  expect(words, "loop", false);
  for (int corner = 0; corner < 3; ++corner) {
    expect(words, "vertex");
    records.points.push_back({words.number("x"), words.number("y"), words.number("z")});
  }
  expect(words, "endloop");
  expect(words, "endfacet");
}

}  // namespace bespoke
