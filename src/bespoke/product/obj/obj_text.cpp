#include "bespoke/product/obj/obj_text.h"

#include <optional>

#include "bespoke/product/obj/obj_statements.h"

namespace bespoke {
namespace {

class Reader {
 public:
  Reader(const TextBlock& text, const std::filesystem::path& path) : words_(text, path, obj_syntax) {}

  ObjText run() {
    while (words_.next_line()) {
      const std::string_view keyword = words_.word();
      switch (obj_statement(keyword)) {
        case ObjStatement::position:
          read_element(obj_position);
          break;
        case ObjStatement::texture:
          read_element(obj_texture);
          break;
        case ObjStatement::normal:
          read_element(obj_normal);
          break;
        case ObjStatement::face:
        case ObjStatement::line:
        case ObjStatement::point:
          read_corners(keyword);
          break;
        default:
          break;
      }
    }
    return std::move(text_);
  }

 private:
  void read_element(std::size_t kind) {
    std::vector<ObjVertexData::Number> numbers;
    NumberText number;
    for (std::string_view word = words_.word();
         !word.empty() && read_number(word.data(), word.data() + word.size(), number); word = words_.word())
      numbers.push_back({number.value, number.decimals});
    text_.data[kind].add_of_file(std::move(numbers));
  }

  void read_corners(std::string_view keyword) {
    ObjElement element;
    element.keyword = keyword;
    element.is_face = obj_statement(keyword) == ObjStatement::face;
    element.is_line = obj_statement(keyword) == ObjStatement::line;
    std::vector<ObjElementCorner>& corners = element.is_face ? text_.faces : text_.others;
    element.first = corners.size();
    for (std::size_t kind = 0; kind < obj_kinds; ++kind) element.before[kind] = text_.data[kind].of_file();
    for (std::string_view word = words_.word(); !word.empty(); word = words_.word()) {
      const std::optional<ObjCorner> read = read_corner(word);
      if (!read) words_.fail("the file has changed while it was read");
      ObjElementCorner corner;
      corner.word = word;
      for (std::size_t kind = 0; kind < obj_kinds; ++kind)
        if (const long long index = read->index[kind]; index != 0)
          corner.data[kind] = static_cast<int>(index < 0 ? element.before[kind] + index : index - 1);
      corners.push_back(corner);
      element.text = {keyword.data(), static_cast<std::size_t>(word.data() + word.size() - keyword.data())};
    }
    element.last = corners.size();
    text_.elements.push_back(element);
  }

  TextWords words_;
  ObjText text_;
};

}  // namespace

ObjText read_obj_text(std::string_view text, const std::filesystem::path& path) {
  TextBlock block;
  block.bytes = text;
  return Reader(block, path).run();
}

}  // namespace bespoke
