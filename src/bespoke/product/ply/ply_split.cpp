#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/product/carry/directions.h"
#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/faces/face_parts.h"
#include "bespoke/product/ply/ply_records.h"
#include "bespoke/product/ply/ply_text.h"
#include "bespoke/product/text/text_edits.h"

namespace bespoke {
namespace {

/// Of whole numbers only colours have a middle; others are names.
bool has_middle(const PlyProperty& property) {
  constexpr std::array<std::string_view, 4> colours{"red", "green", "blue", "alpha"};
  return is_real(property.type) || std::any_of(colours.begin(), colours.end(), [&](std::string_view colour) {
           return property.name.ends_with(colour);
         });
}

std::vector<SplitNumber> middle_values(const PlyProperty& property, const std::vector<SplitNumber>& a,
                                       const std::vector<SplitNumber>& b) {
  if (!has_middle(property) || a.size() != b.size()) return a;
  std::vector<SplitNumber> middle(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) middle[k] = middle_number(a[k], b[k], !is_real(property.type));
  return middle;
}

Vector3 direction_of(const PlyValues& values, const std::array<std::size_t, 3>& triple) {
  return {values[triple[0]][0].value, values[triple[1]][0].value, values[triple[2]][0].value};
}

/// A corner of a polygon.
struct Corner {
  SplitNumber vertex;
  std::vector<SplitNumber> texture;
};

class PlySplitter {
 public:
  PlySplitter(const InputFile& file, const PlyHeader& header, std::string_view text, const FaceSplits& splits)
      : header_(header),
        splits_(splits),
        face_(face_element(header)),
        faces_(splits, face_ < header.elements.size() ? header.elements[face_].count : 0, file.path()),
        edges_(ply_edges(header)),
        records_(file, text, header) {
    for (std::size_t i = 0; i < splits.vertices.size(); ++i)
      middles_.emplace(std::minmax(splits.vertices[i].first, splits.vertices[i].second),
                       static_cast<int>(header.elements[header.vertex].count + i));
    if (face_ == header.elements.size()) return;
    const std::vector<PlyProperty>& properties = header.elements[face_].properties;
    for (std::size_t i = 0; i < properties.size(); ++i) {
      if (is_face_list(header.elements[face_], properties[i])) indices_ = i;
      if (properties[i].name == "texcoord" && properties[i].count) texture_ = i;
    }
  }

  /// The file's bytes behind its header.
  std::string body() {
    std::string body;
    for (std::size_t i = 0; i < header_.elements.size(); ++i) {
      if (i == face_) {
        append_faces(body);
        continue;
      }
      if (edges_ && i == edges_->element) {
        append_edges(body);
        continue;
      }
      body += records_.text(i, 0, header_.elements[i].count);
      if (i == header_.vertex) append_vertices(body);
    }
    return body += records_.text_behind_all();
  }

  std::size_t vertices() const { return header_.elements[header_.vertex].count + splits_.vertices.size(); }
  std::size_t faces() const { return faces_.count(); }
  /// Lines, once the body is there; none where the file has none.
  std::optional<std::size_t> edges() const { return edges_ ? std::optional(edge_count_) : std::nullopt; }

 private:
  static std::size_t face_element(const PlyHeader& header) {
    const auto named = [](const PlyElement& element) { return element.name == "face"; };
    return static_cast<std::size_t>(std::find_if(header.elements.begin(), header.elements.end(), named) -
                                    header.elements.begin());
  }

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
    const Vector3 normal =
        middle_direction(direction_of(a, *header_.normal), direction_of(b, *header_.normal));
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      middle[(*header_.normal)[static_cast<std::size_t>(axis)]][0].value = normal[axis];
    return middle;
  }

  void append_faces(std::string& body) const {
    const std::size_t polygons = header_.elements[face_].count;
    std::size_t written = 0;
    for (std::size_t p = 0; p < polygons; ++p) {
      if (!faces_.is_split(p)) continue;
      body += records_.text(face_, written, p);
      append_parts(body, p);
      written = p + 1;
    }
    body += records_.text(face_, written, polygons);
  }

  /// A line that is split becomes several, each with the rest of its record.
  void append_edges(std::string& body) {
    for (std::size_t i = 0; i < header_.elements[edges_->element].count; ++i) {
      PlyValues record = records_.values(edges_->element, i);
      const auto end = [&](std::size_t k) { return static_cast<int>(record[edges_->ends[k]][0].value); };
      std::vector<int> places{end(0)};
      append_places(end(0), end(1), places);
      edge_count_ += places.size() - 1;
      if (places.size() == 2) {
        body += records_.text(edges_->element, i, i + 1);
        continue;
      }
      for (std::size_t k = 0; k + 1 < places.size(); ++k) {
        record[edges_->ends[0]][0] = {double(places[k]), 0, {}};
        record[edges_->ends[1]][0] = {double(places[k + 1]), 0, {}};
        records_.append(body, edges_->element, record);
      }
    }
  }

  /// What lies between two vertices in their order, and the second.
  void append_places(int a, int b, std::vector<int>& places) const {
    const auto found = middles_.find(std::minmax(a, b));
    if (found == middles_.end()) return places.push_back(b);
    append_places(a, found->second, places);
    append_places(found->second, b, places);
  }

  void append_parts(std::string& body, std::size_t polygon) const {
    const PlyValues face = records_.values(face_, polygon);
    const auto middle = [&](const Corner& a, const Corner& b, int vertex) {
      Corner corner;
      corner.vertex.value = vertex;
      if (has_texture(face))
        corner.texture = middle_values(header_.elements[face_].properties[*texture_], a.texture, b.texture);
      return corner;
    };
    for (const std::vector<Corner>& part : faces_.parts(polygon, corners_of(face), middle)) {
      PlyValues values = face;
      values[indices_].clear();
      if (has_texture(face)) values[*texture_].clear();
      for (const Corner& corner : part) {
        values[indices_].push_back(corner.vertex);
        if (has_texture(face))
          values[*texture_].insert(values[*texture_].end(), corner.texture.begin(), corner.texture.end());
      }
      records_.append(body, face_, values);
    }
  }

  std::vector<Corner> corners_of(const PlyValues& face) const {
    std::vector<Corner> corners(face[indices_].size());
    for (std::size_t k = 0; k < corners.size(); ++k) {
      corners[k].vertex = face[indices_][k];
      if (has_texture(face)) corners[k].texture = {face[*texture_][2 * k], face[*texture_][2 * k + 1]};
    }
    return corners;
  }

  /// Two numbers a corner, as several programs write them.
  bool has_texture(const PlyValues& face) const {
    return texture_ && face[*texture_].size() == 2 * face[indices_].size();
  }

  const PlyHeader& header_;
  const FaceSplits& splits_;
  std::size_t face_;  // the element
  FaceParts faces_;
  std::optional<PlyEdges> edges_;
  std::map<std::pair<int, int>, int> middles_;  // of edges, by their ends
  std::size_t edge_count_ = 0;
  PlyRecords records_;
  std::size_t indices_ = 0;             // its property
  std::optional<std::size_t> texture_;  // likewise
};

/// The header with other numbers of elements.
std::string with_counts(std::string_view head,
                        const std::array<std::pair<std::string, std::size_t>, 3>& counts) {
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
  const std::string text = file.content();
  const PlyHeader header = read_ply_header(file);
  PlySplitter splitter(file, header, text, splits);
  const std::string body = splitter.body();
  output.write(with_counts(std::string_view(text).substr(0, header.size),
                           {{{"vertex", splitter.vertices()},
                             {"face", splitter.faces()},
                             {splitter.edges() ? "edge" : "", splitter.edges().value_or(0)}}}));
  output.write(body);
}

}  // namespace bespoke
