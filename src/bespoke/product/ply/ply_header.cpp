#include "bespoke/product/ply/ply_header.h"

#include <algorithm>

#include "bespoke/error.h"
#include "bespoke/product/text/text_records.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

constexpr LineSyntax header_syntax{0, false};

PlyScalar scalar(TextWords& words, std::string_view word) {
  if (word == "char" || word == "int8") return PlyScalar::int8;
  if (word == "uchar" || word == "uint8") return PlyScalar::uint8;
  if (word == "short" || word == "int16") return PlyScalar::int16;
  if (word == "ushort" || word == "uint16") return PlyScalar::uint16;
  if (word == "int" || word == "int32") return PlyScalar::int32;
  if (word == "uint" || word == "uint32") return PlyScalar::uint32;
  if (word == "float" || word == "float32") return PlyScalar::float32;
  if (word == "double" || word == "float64") return PlyScalar::float64;
  words.fail("unknown type " + in_quotes(word));
}

PlyHeader::Encoding encoding(TextWords& words) {
  const std::string_view word = words.word();
  if (word == "ascii") return PlyHeader::Encoding::ascii;
  if (word == "binary_little_endian") return PlyHeader::Encoding::little_endian;
  if (word == "binary_big_endian") return PlyHeader::Encoding::big_endian;
  words.fail("unknown format " + in_quotes(word));
}

PlyElement element(TextWords& words, const PlyHeader& header) {
  PlyElement result;
  result.name = words.word();
  const long long count = words.integer("number of elements");
  if (count < 0) words.fail("a negative number of elements");
  for (const PlyElement& other : header.elements)
    if (other.name == result.name) words.fail("a second element " + in_quotes(result.name));
  result.count = static_cast<std::uint64_t>(count);
  return result;
}

PlyProperty property(TextWords& words) {
  PlyProperty result;
  std::string_view word = words.word();
  if (word == "list") {
    result.count = scalar(words, words.word());
    if (is_real(*result.count)) words.fail("the length of a list must be a whole number");
    word = words.word();
  }
  result.type = scalar(words, word);
  result.name = words.word();
  if (result.name.empty()) words.fail("a property without a name");
  return result;
}

/// The properties of these names; none unless all are there.
template <std::size_t n>
std::optional<std::array<std::size_t, n>> find_properties(const PlyElement& element,
                                                          const std::array<const char*, n>& names) {
  std::array<std::size_t, n> found{};
  for (std::size_t i = 0; i < n; ++i) {
    const auto named = [&](const PlyProperty& p) { return p.name == names[i] && !p.count; };
    const auto at = std::find_if(element.properties.begin(), element.properties.end(), named);
    if (at == element.properties.end()) return std::nullopt;
    found[i] = static_cast<std::size_t>(at - element.properties.begin());
  }
  return found;
}

void find_vertices(const InputFile& file, PlyHeader& header) {
  const auto at = std::find_if(header.elements.begin(), header.elements.end(),
                               [](const PlyElement& e) { return e.name == "vertex"; });
  if (at == header.elements.end() || at->count == 0)
    throw FormatError(file.path().string() + ": the file has no vertices");
  header.vertex = static_cast<std::size_t>(at - header.elements.begin());
  const auto position = find_properties<3>(*at, {"x", "y", "z"});
  if (!position) throw FormatError(file.path().string() + ": vertices have no x, y and z");
  header.position = *position;
  header.normal = find_properties<3>(*at, {"nx", "ny", "nz"});
  // The names that several programs use.
  for (const auto& names : {std::array{"u", "v"}, std::array{"s", "t"}, std::array{"texture_u", "texture_v"}})
    if (!header.texture) header.texture = find_properties<2>(*at, names);
}

}  // namespace

std::optional<std::size_t> PlyElement::record_size() const {
  std::size_t sum = 0;
  for (const PlyProperty& property : properties) {
    if (property.count) return std::nullopt;
    sum += size(property.type);
  }
  return sum;
}

PlyHeader read_ply_header(const InputFile& file) {
  const std::string head = text_head(file);
  TextBlock block;
  block.bytes = head;
  TextWords words(block, file.path(), header_syntax);
  PlyHeader header;
  if (!words.next_line() || words.line_begin() != without_byte_order_mark(head).data() ||
      words.word() != "ply")
    throw FormatError(file.path().string() + ":1: a PLY file begins with ply");
  bool has_format = false;
  while (true) {
    if (!words.next_line()) words.fail("the file ends before end_header");
    const std::string_view keyword = words.word();
    if (keyword == "end_header") break;
    if (keyword == "format") {
      header.encoding = encoding(words);
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(element(words, header));
    } else if (keyword == "property") {
      if (header.elements.empty()) words.fail("a property before the first element");
      header.elements.back().properties.push_back(property(words));
    } else if (keyword != "comment" && keyword != "obj_info") {
      words.fail("unknown word " + in_quotes(keyword) + " in the header");
    }
  }
  if (!has_format) words.fail("the header names no format");
  header.size = static_cast<std::size_t>(words.line_end() - head.data());
  const std::string_view whole = std::string_view(head).substr(0, header.size);
  if (!whole.ends_with('\n') && !whole.ends_with('\r')) words.fail("the file ends behind its header");
  // Where lines end at CR alone, an LF behind the last one is a byte of the body.
  if (first_line_break(head) == "\r" && whole.ends_with("\r\n")) --header.size;
  header.lines = count_line_breaks(whole);
  find_vertices(file, header);
  return header;
}

std::string ply_index_fault(double index, std::uint64_t vertices) {
  if (index >= 0 && index < static_cast<double>(vertices)) return "";
  return "a face names vertex " + std::to_string(static_cast<long long>(index)) + ", outside 0 … " +
         std::to_string(vertices - 1);
}

std::optional<PlyEdges> ply_edges(const PlyHeader& header) {
  for (std::size_t e = 0; e < header.elements.size(); ++e) {
    const PlyElement& element = header.elements[e];
    if (element.name != "edge" || element.count == 0) continue;
    PlyEdges edges{e, {}};
    std::size_t found = 0;
    for (std::size_t i = 0; i < element.properties.size(); ++i)
      for (std::size_t k = 0; k < edges.ends.size(); ++k)
        if (element.properties[i].name == (k == 0 ? "vertex1" : "vertex2") && !element.properties[i].count) {
          edges.ends[k] = i;
          ++found;
        }
    if (found == edges.ends.size()) return edges;
  }
  return std::nullopt;
}

bool is_face_list(const PlyElement& element, const PlyProperty& property) {
  return property.count && element.name == "face" &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

}  // namespace bespoke
