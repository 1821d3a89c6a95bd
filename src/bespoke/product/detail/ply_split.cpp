#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/product/detail/ply_records.h"
#include "bespoke/product/detail/ply_text.h"
#include "bespoke/product/detail/product_formats.h"
#include "bespoke/product/detail/text_edits.h"

namespace bespoke {
namespace {

constexpr int least_real_decimals = 6;  // of new numbers that are no position

/// Of whole numbers only colours have a middle; others are names.
bool has_middle(const PlyProperty& property) {
  constexpr std::array<std::string_view, 4> colours{"red", "green", "blue", "alpha"};
  return is_real(property.type) || std::any_of(colours.begin(), colours.end(), [&](std::string_view colour) {
           return property.name.ends_with(colour);
         });
}

std::vector<PlyNumber> middle_values(const PlyProperty& property, const std::vector<PlyNumber>& a,
                                     const std::vector<PlyNumber>& b) {
  if (!has_middle(property) || a.size() != b.size()) return a;
  std::vector<PlyNumber> middle(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double mean = 0.5 * (a[k].value + b[k].value);
    middle[k] = {is_real(property.type) ? mean : std::floor(mean + 0.5),
                 std::max({a[k].decimals, b[k].decimals, least_real_decimals}),
                 {}};
  }
  return middle;
}

double length_of(const PlyValues& values, const std::array<std::size_t, 3>& triple) {
  return std::hypot(values[triple[0]][0].value, values[triple[1]][0].value, values[triple[2]][0].value);
}

/// A corner of a polygon.
struct Corner {
  PlyNumber vertex;
  std::vector<PlyNumber> texture;
};

class PlySplitter {
 public:
  PlySplitter(const InputFile& file, const PlyHeader& header, std::string_view text, const FaceSplits& splits)
      : header_(header), splits_(splits), records_(file, text, header) {
    const auto named = [](const PlyElement& element) { return element.name == "face"; };
    face_ = static_cast<std::size_t>(std::find_if(header.elements.begin(), header.elements.end(), named) -
                                     header.elements.begin());
    if (face_ == header.elements.size() || polygons() != header.elements[face_].count ||
        splits.part_corners.empty())
      throw InvalidInput(file.path().string() + ": it has other faces than those whose edges were split");
    const std::vector<PlyProperty>& properties = header.elements[face_].properties;
    for (std::size_t i = 0; i < properties.size(); ++i) {
      if (is_face_list(header.elements[face_], properties[i])) indices_ = i;
      if (properties[i].name == "texcoord" && properties[i].count) texture_ = i;
    }
    const int last = *std::max_element(splits.part_corners.begin(), splits.part_corners.end());
    first_made_ = last + 1 - static_cast<int>(splits.corners.size());
  }

  /// The file's bytes behind its header.
  std::string body() {
    std::string body;
    for (std::size_t i = 0; i < header_.elements.size(); ++i) {
      if (i == face_) {
        append_faces(body);
        continue;
      }
      body += records_.text(i, 0, header_.elements[i].count);
      if (i == header_.vertex) append_vertices(body);
    }
    return body += records_.text_behind_all();
  }

  std::size_t vertices() const { return header_.elements[header_.vertex].count + splits_.vertices.size(); }
  std::size_t faces() const { return static_cast<std::size_t>(splits_.first_part.back()); }

 private:
  std::size_t polygons() const { return splits_.first_part.size() - 1; }

  void append_vertices(std::string& body) {
    const std::size_t before = header_.elements[header_.vertex].count;
    std::vector<PlyValues> made;
    const auto values = [&](int vertex) {
      const auto i = static_cast<std::size_t>(vertex);
      return i < before ? records_.values(header_.vertex, i) : made[i - before];
    };
    for (const auto& [a, b] : splits_.vertices) {
      made.push_back(middle(values(a), values(b)));
      records_.append(body, header_.vertex, made.back());
    }
  }

  PlyValues middle(const PlyValues& a, const PlyValues& b) const {
    const std::vector<PlyProperty>& properties = header_.elements[header_.vertex].properties;
    PlyValues middle(properties.size());
    for (std::size_t i = 0; i < properties.size(); ++i) middle[i] = middle_values(properties[i], a[i], b[i]);
    for (const std::size_t axis : header_.position) middle[axis][0].decimals = records_.position_decimals();
    if (!header_.normal) return middle;
    const double length = length_of(middle, *header_.normal);
    const double ends = 0.5 * (length_of(a, *header_.normal) + length_of(b, *header_.normal));
    for (const std::size_t axis : *header_.normal)
      if (length > 0) middle[axis][0].value *= ends / length;
    return middle;
  }

  void append_faces(std::string& body) const {
    std::size_t written = 0;
    for (std::size_t p = 0; p < polygons(); ++p) {
      if (!is_split(p)) continue;
      body += records_.text(face_, written, p);
      append_parts(body, p);
      written = p + 1;
    }
    body += records_.text(face_, written, polygons());
  }

  bool is_split(std::size_t polygon) const {
    const auto begin = splits_.part_corners.begin();
    return std::any_of(begin + part_start(first_part(polygon)), begin + part_start(first_part(polygon + 1)),
                       [&](int corner) { return corner >= first_made_; });
  }

  void append_parts(std::string& body, std::size_t polygon) const {
    const PlyValues face = records_.values(face_, polygon);
    const std::map<int, Corner> corners = corners_of(polygon, face);
    for (int part = first_part(polygon); part < first_part(polygon + 1); ++part) {
      PlyValues values = face;
      values[indices_].clear();
      if (has_texture(face)) values[*texture_].clear();
      for (int k = part_start(part); k < part_start(part + 1); ++k) {
        const Corner& corner = corners.at(splits_.part_corners[static_cast<std::size_t>(k)]);
        values[indices_].push_back(corner.vertex);
        if (has_texture(face))
          values[*texture_].insert(values[*texture_].end(), corner.texture.begin(), corner.texture.end());
      }
      records_.append(body, face_, values);
    }
  }

  /// By their numbers. What a corner lies between has smaller ones, and is a corner of the polygon's parts.
  std::map<int, Corner> corners_of(std::size_t polygon, const PlyValues& face) const {
    const auto begin = splits_.part_corners.begin();
    std::map<int, Corner> corners;
    std::for_each(begin + part_start(first_part(polygon)), begin + part_start(first_part(polygon + 1)),
                  [&](int number) { corners[number]; });
    std::size_t place = 0;  // of the file's corners, which come first
    for (auto& [number, corner] : corners) {
      if (number < first_made_) {
        corner.vertex = face[indices_][place];
        if (has_texture(face)) corner.texture = {face[*texture_][2 * place], face[*texture_][2 * place + 1]};
        ++place;
        continue;
      }
      const FaceSplits::Corner& split = splits_.corners[static_cast<std::size_t>(number - first_made_)];
      corner.vertex.value = split.vertex;
      if (has_texture(face))
        corner.texture = middle_values(header_.elements[face_].properties[*texture_],
                                       corners.at(split.before).texture, corners.at(split.behind).texture);
    }
    return corners;
  }

  /// Two numbers a corner, as several programs write them.
  bool has_texture(const PlyValues& face) const {
    return texture_ && face[*texture_].size() == 2 * face[indices_].size();
  }

  int first_part(std::size_t polygon) const { return splits_.first_part[polygon]; }
  int part_start(int part) const { return splits_.part_start[static_cast<std::size_t>(part)]; }

  const PlyHeader& header_;
  const FaceSplits& splits_;
  PlyRecords records_;
  std::size_t face_ = 0;                // the element
  std::size_t indices_ = 0;             // its property
  std::optional<std::size_t> texture_;  // likewise
  int first_made_ = 0;                  // number of the first corner that the file does not have
};

/// The header with other numbers of elements.
std::string with_counts(std::string_view head,
                        const std::array<std::pair<std::string, std::size_t>, 2>& counts) {
  TextBlock block;
  block.bytes = head;
  const std::filesystem::path read_before;
  TextWords words(block, read_before, ply_body_syntax);
  std::vector<TextEdit> edits;
  while (words.next_line()) {
    if (words.word() != "element") continue;
    const std::string_view name = words.word(), count = words.word();
    for (const auto& [element, number] : counts)
      if (name == element) edits.push_back({count, std::to_string(number)});
  }
  return edited(head, {}, std::move(edits));
}

}  // namespace

// Faces were read whole to be split, so the file may be too.
void split_ply(const InputFile& file, const FaceSplits& splits, OutputFile& output) {
  std::string text(file.size(), '\0');
  file.read(0, text.data(), text.size());
  const PlyHeader header = read_ply_header(file);
  PlySplitter splitter(file, header, text, splits);
  const std::string body = splitter.body();
  output.write(with_counts(std::string_view(text).substr(0, header.size),
                           {{{"vertex", splitter.vertices()}, {"face", splitter.faces()}}}));
  output.write(body);
}

}  // namespace bespoke
