#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/product/carry/directions.h"
#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/faces/face_parts.h"
#include "bespoke/product/obj/obj_check.h"
#include "bespoke/product/obj/obj_statements.h"
#include "bespoke/product/obj/obj_text.h"
#include "bespoke/product/text/text_records.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

constexpr std::array<const char*, obj_kinds> kind_keywords{"v", "vt", "vn"};
constexpr int min_decimals = 6;  // of new numbers that are no position

/// The mean of two; of normals as long as they are in the mean.
std::vector<ObjVertexData::Number> middle_numbers(std::size_t kind,
                                                  const std::vector<ObjVertexData::Number>& a,
                                                  const std::vector<ObjVertexData::Number>& b) {
  std::vector<ObjVertexData::Number> middle;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    middle.push_back({0.5 * (a[k].value + b[k].value), std::max(a[k].decimals, b[k].decimals)});
  if (kind != obj_normal) return middle;
  const Vector3 normal =
      middle_direction({a[0].value, a[1].value, a[2].value}, {b[0].value, b[1].value, b[2].value});
  for (std::size_t axis = 0; axis < 3; ++axis) middle[axis].value = normal[static_cast<Eigen::Index>(axis)];
  return middle;
}

/// Gives the corners that splits have made their vertex data, new ones where there are none yet: an edge that
/// faces share gets one middle, and so do texture coordinates and normals that they share along it.
class CornerMaker {
 public:
  CornerMaker(ObjText& obj, const FaceSplits& splits, const FaceParts& parts)
      : obj_(obj),
        splits_(splits),
        parts_(parts),
        middles_(splits.vertices.size(), no_obj_data),
        pairs_normals_(obj.data[obj_normal].of_file() == obj.data[obj_position].of_file() &&
                       std::all_of(obj.faces.begin(), obj.faces.end(),
                                   [](const ObjElementCorner& corner) {
                                     return corner.data[obj_normal] == no_obj_data;
                                   }) &&
                       std::all_of(obj.elements.begin(), obj.elements.end(), [](const ObjElement& element) {
                         return element.before[obj_normal] == element.before[obj_position];
                       })) {}

  void run() {
    for (std::size_t i = 0; i < splits_.vertices.size(); ++i)
      edges_.emplace(std::minmax(splits_.vertices[i].first, splits_.vertices[i].second), static_cast<int>(i));
    obj_.faces.resize(obj_.faces.size() + splits_.corners.size());
    std::size_t polygon = 0;
    for (ObjElement& element : obj_.elements) {
      element.made_before = made();
      if (element.is_face) make(polygon++, element);
      if (element.is_line) split_line(element);
      element.made_until = made();
    }
  }

 private:
  void split_line(ObjElement& element) {
    std::vector<ObjKinds> split{obj_.others[element.first].data};
    for (std::size_t k = element.first + 1; k < element.last; ++k)
      append_edge(obj_.others[k - 1].data, obj_.others[k].data, element, split);
    if (split.size() == element.last - element.first) return;
    for (ObjKinds& corner : split) corner[obj_position] = datum(corner[obj_position]);
    element.split = std::move(split);
  }

  /// What lies between the ends of a line's edge, in their order, and its end. `a` and `b` are said of
  /// vertices of the product, which are numbered otherwise than data are.
  void append_edge(const ObjKinds& a, const ObjKinds& b, const ObjElement& element,
                   std::vector<ObjKinds>& split) {
    const auto found = edges_.find(std::minmax(a[obj_position], b[obj_position]));
    if (found == edges_.end()) {
      split.push_back(b);
      return;
    }
    middle_of_edge(found->second, element);
    ObjKinds middle{obj_.data[obj_position].of_file() + found->second, no_obj_data, no_obj_data};
    for (std::size_t kind = obj_texture; kind < obj_kinds; ++kind)
      middle[kind] = middle_of(kind, a[kind], b[kind], element);
    append_edge(a, middle, element, split);
    append_edge(middle, b, element, split);
  }

  ObjKinds made() const {
    ObjKinds made;
    for (std::size_t kind = 0; kind < obj_kinds; ++kind) made[kind] = obj_.data[kind].added();
    return made;
  }

  void make(std::size_t polygon, const ObjElement& element) {
    for (const int number : parts_.corners(polygon)) {
      const FaceSplits::Corner* const split = parts_.between(number);
      if (!split) continue;
      const auto corner = static_cast<std::size_t>(number);
      ObjKinds& data = obj_.faces[corner].data;
      data[obj_position] = middle_of_edge(split->vertex - obj_.data[obj_position].of_file(), element);
      for (std::size_t kind = obj_texture; kind < obj_kinds; ++kind)
        data[kind] = middle_of(kind, obj_.faces[static_cast<std::size_t>(split->before)].data[kind],
                               obj_.faces[static_cast<std::size_t>(split->behind)].data[kind], element);
    }
  }

  /// Of a vertex of the product whose datum is made already, or is in the file.
  int datum(int vertex) const {
    const int made = vertex - obj_.data[obj_position].of_file();
    return made < 0 ? vertex : middles_[static_cast<std::size_t>(made)];
  }

  int middle_of_edge(int edge, const ObjElement& element) {
    int& middle = middles_[static_cast<std::size_t>(edge)];
    if (middle != no_obj_data) return middle;
    const auto [a, b] = splits_.vertices[static_cast<std::size_t>(edge)];
    middle = add(obj_position, datum(a), datum(b), element);
    if (pairs_normals_) add(obj_normal, datum(a), datum(b), element);
    return middle;
  }

  int middle_of(std::size_t kind, int a, int b, const ObjElement& element) {
    if (a == no_obj_data || b == no_obj_data) return no_obj_data;
    if (a == b) return a;
    const auto [found, is_new] = shared_[kind].try_emplace({std::min(a, b), std::max(a, b)}, no_obj_data);
    if (is_new) found->second = add(kind, a, b, element);
    return found->second;
  }

  int add(std::size_t kind, int a, int b, const ObjElement& element) {
    ObjVertexData& data = obj_.data[kind];
    return data.add(middle_numbers(kind, data.numbers(a), data.numbers(b)), element.before[kind]);
  }

  ObjText& obj_;
  const FaceSplits& splits_;
  const FaceParts& parts_;
  std::vector<int> middles_;                  // of the splits' edges
  std::map<std::pair<int, int>, int> edges_;  // their numbers, by their vertices
  std::array<std::map<std::pair<int, int>, int>, obj_kinds> shared_;
  bool pairs_normals_;  // no corner names any, and as many as positions stand in front of every element
};

/// Writes the faces that are split, and the others anew where their numbers change.
class Writer {
 public:
  Writer(std::string_view text, const ObjText& obj, const FaceParts& parts, const ObjContent& found)
      : text_(text),
        obj_(obj),
        parts_(parts),
        position_decimals_(position_decimals(found.box, found.position_decimals)),
        normal_decimals_(std::max(min_decimals, found.normal_decimals.decimals())) {}

  std::string run() const {
    std::vector<TextEdit> edits;
    std::size_t polygon = 0;
    for (const ObjElement& element : obj_.elements) {
      if (element.is_face && parts_.is_split(polygon))
        edits.push_back({element.text, with_parts(polygon, element)});
      else if (!element.split.empty())
        edits.push_back({element.text, split_line(element)});
      else
        renumber(element, edits);
      if (element.is_face) ++polygon;
    }
    return edited(text_, {}, std::move(edits));
  }

 private:
  /// The new vertex data that stand in front of a line, and the line.
  std::string split_line(const ObjElement& element) const {
    std::string text = made_data(element) + std::string(element.keyword);
    for (const ObjKinds& corner : element.split) text.append(" ").append(word(corner, {}));
    return text;
  }

  /// The same of a face, and its parts.
  std::string with_parts(std::size_t polygon, const ObjElement& element) const {
    const std::string line_break = line_break_behind(element);
    std::string text = made_data(element);
    for (int part = parts_.first(polygon); part < parts_.first(polygon + 1); ++part) {
      if (part > parts_.first(polygon)) text += line_break;
      text += element.keyword;
      for (const int corner : parts_.corners_of_part(part))
        text.append(" ").append(word(obj_.faces[static_cast<std::size_t>(corner)].data, {}));
    }
    return text;
  }

  std::string made_data(const ObjElement& element) const {
    const std::string line_break = line_break_behind(element);
    std::string text;
    for (std::size_t kind = 0; kind < obj_kinds; ++kind)
      for (int i = element.made_before[kind]; i < element.made_until[kind]; ++i) {
        text += kind_keywords[kind];
        const std::vector<ObjVertexData::Number>& numbers =
            obj_.data[kind].numbers(obj_.data[kind].of_file() + i);
        for (std::size_t k = 0; k < numbers.size(); ++k) {
          text += ' ';
          append_number(text, numbers[k].value, decimals(kind, k, numbers[k]));
        }
        text += line_break;
      }
    return text;
  }

  int decimals(std::size_t kind, std::size_t k, const ObjVertexData::Number& number) const {
    if (kind == obj_position && k < 3) return position_decimals_;
    return kind == obj_normal ? normal_decimals_ : std::max(min_decimals, number.decimals);
  }

  void renumber(const ObjElement& element, std::vector<TextEdit>& edits) const {
    const std::vector<ObjElementCorner>& corners = element.is_face ? obj_.faces : obj_.others;
    for (std::size_t k = element.first; k < element.last; ++k) {
      const ObjElementCorner& corner = corners[k];
      const ObjCorner read = *read_corner(corner.word);
      ObjKinds counted_back{};
      for (std::size_t kind = 0; kind < obj_kinds; ++kind)
        if (read.index[kind] < 0) counted_back[kind] = element.before[kind] + element.made_until[kind];
      std::string now = word(corner.data, counted_back);
      if (now != word_as_read(read)) edits.push_back({corner.word, std::move(now)});
    }
  }

  /// A corner by its data; kinds with a count are counted back from it.
  std::string word(const ObjKinds& data, const ObjKinds& counted_back) const {
    std::array<long long, obj_kinds> number{};
    for (std::size_t kind = 0; kind < obj_kinds; ++kind) {
      if (data[kind] == no_obj_data) continue;
      const int place = obj_.data[kind].place(data[kind]);
      number[kind] = counted_back[kind] > 0 ? place - counted_back[kind] : place + 1;
    }
    return word(number);
  }

  static std::string word_as_read(const ObjCorner& corner) { return word(corner.index); }

  static std::string word(const std::array<long long, obj_kinds>& number) {
    std::string text = std::to_string(number[obj_position]);
    if (number[obj_texture] != 0 || number[obj_normal] != 0) text += '/';
    if (number[obj_texture] != 0) text += std::to_string(number[obj_texture]);
    if (number[obj_normal] != 0) text.append("/").append(std::to_string(number[obj_normal]));
    return text;
  }

  std::string line_break_behind(const ObjElement& element) const {
    const auto behind = static_cast<std::size_t>(element.text.data() + element.text.size() - text_.data());
    return std::string(first_line_break(text_.substr(behind)));
  }

  std::string_view text_;
  const ObjText& obj_;
  const FaceParts& parts_;
  int position_decimals_, normal_decimals_;
};

}  // namespace

// Faces were read whole to be split, so their text may be too.
void split_obj(const InputFile& file, const FaceSplits& splits, OutputFile& output) {
  const ObjContent found = check_obj_product(file, {});
  if (found.has_free_form)
    throw InvalidInput(file.path().string() +
                       ": has free-form statements (vp, curv, surf), whose vertices cannot be renumbered; it "
                       "can be refined without them");
  const std::string text = file.content();
  ObjText obj = read_obj_text(text, file.path());
  const auto polygons = std::count_if(obj.elements.begin(), obj.elements.end(),
                                      [](const ObjElement& element) { return element.is_face; });
  const FaceParts parts(splits, static_cast<std::size_t>(polygons), file.path());
  CornerMaker(obj, splits, parts).run();
  output.write(Writer(text, obj, parts, found).run());
}

}  // namespace bespoke
