#include "bespoke/product/ply/ply_text.h"

#include <algorithm>

#include "bespoke/error.h"

namespace bespoke {

PlyText::PlyText(const std::filesystem::path& path, const PlyHeader& header) : path_(path), header_(header) {
  std::uint64_t end = 0;
  for (const PlyElement& element : header.elements)
    ends_.push_back(end += element.properties.empty() ? 0 : element.count);
}

TextCutter PlyText::cutter() const { return {path_, header_.lines + 1, line_counter(ply_body_syntax)}; }

TextRecords PlyText::records(const TextBlock& block) const {
  TextRecords records;
  TextWords words(block, path_, ply_body_syntax);
  std::uint64_t number = block.before[0];
  auto element =
      static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end(), number) - ends_.begin());
  for (; words.next_line(); ++number) {
    while (element < ends_.size() && number >= ends_[element]) ++element;
    if (element == ends_.size()) words.fail("a line behind the last element");
    if (element == header_.vertex)
      read_vertex(words, records);
    else
      read_other(words, header_.elements[element], records);
    if (!words.word().empty()) words.fail("more words than the element has properties");
  }
  return records;
}

void PlyText::read_vertex(TextWords& words, TextRecords& records) const {
  const std::vector<PlyProperty>& properties = header_.elements[header_.vertex].properties;
  NumberTriple position, normal, texture;
  for (std::size_t i = 0; i < properties.size(); ++i) {
    NumberText* slot = nullptr;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (header_.position[axis] == i) slot = &position[axis];
      if (header_.normal && (*header_.normal)[axis] == i) slot = &normal[axis];
      if (header_.texture && axis < 2 && (*header_.texture)[axis] == i) slot = &texture[axis];
    }
    if (slot) {
      *slot = words.number(properties[i].name.c_str());
      continue;
    }
    const long long count = properties[i].count ? list_length(words) : 1;
    for (long long k = 0; k < count; ++k)
      if (words.word().empty()) words.fail("missing " + properties[i].name);
  }
  records.points.push_back(position);
  if (header_.normal) records.normals.push_back(normal);
  if (header_.texture) records.texture.push_back({texture[0].value, texture[1].value});
}

void PlyText::read_other(TextWords& words, const PlyElement& element, TextRecords& records) const {
  const std::uint64_t vertices = header_.elements[header_.vertex].count;
  for (const PlyProperty& property : element.properties) {
    const long long count = property.count ? list_length(words) : 1;
    const bool is_face = is_face_list(element, property);
    if (is_face) records.faces.push_back(static_cast<std::uint32_t>(count));
    for (long long k = 0; k < count; ++k) {
      if (is_face) {
        const long long corner = words.integer("corner");
        const std::string fault = ply_index_fault(static_cast<double>(corner), vertices);
        if (!fault.empty()) words.fail(fault);
        records.faces.push_back(static_cast<std::uint32_t>(corner));
      } else if (words.word().empty()) {
        words.fail("missing " + property.name);
      }
    }
  }
}

long long PlyText::list_length(TextWords& words) {
  const long long count = words.integer("length of a list");
  if (count < 0) words.fail("a list of negative length");
  return count;
}

void PlyText::require_complete(const std::array<std::uint64_t, 3>& sums) const {
  if (sums[0] == ends_.back()) return;
  const auto element =
      static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end(), sums[0]) - ends_.begin());
  const PlyElement& cut_off = header_.elements[element];
  throw FormatError(path_.string() +
                    ": the file ends here: " + std::to_string(sums[0] - (ends_[element] - cut_off.count)) +
                    " of " + std::to_string(cut_off.count) + " elements " + in_quotes(cut_off.name));
}

}  // namespace bespoke
