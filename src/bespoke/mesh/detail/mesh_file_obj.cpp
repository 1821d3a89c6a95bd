#include "bespoke/mesh/detail/mesh_file_formats.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "bespoke/mesh/detail/text_lines.h"

namespace bespoke {
namespace {

enum Kind { position, texture, normal, kinds };
constexpr std::array<const char*, kinds> names{"vertex", "texture coordinate", "normal"};

class ObjCheck {
 public:
  ObjCheck(const std::filesystem::path& path, const std::string& content)
      : path_(path), lines_(path, content, true) {}

  MeshFile run() {
    while (lines_.next_with_words()) {
      const std::string_view keyword = lines_.word();
      if (keyword == "v") {
        read_numbers("v", position, 3);
      } else if (keyword == "vt") {
        read_numbers("vt", texture, 2);
      } else if (keyword == "vn") {
        read_numbers("vn", normal, 3);
      } else if (keyword == "f") {
        read_face();
      }  // everything else carries no geometry, and OpenMesh would open the files that `mtllib` names
    }
    for (const ForwardReference& reference : forward_)
      if (reference.index > count_[reference.kind]) fail(reference);
    if (count_[position] == 0) throw FormatError(path_.string() + ": the file has no vertices");
    file_.vertices = static_cast<std::size_t>(count_[position]);
    return std::move(file_);
  }

 private:
  struct ForwardReference {
    Kind kind;
    long long index;
    TextLines lines;
  };

  void read_numbers(const char* keyword, Kind kind, int numbers) {
    static constexpr std::array<const char*, 3> axes{"x", "y", "z"};
    file_.content += keyword;
    for (int i = 0; i < numbers; ++i)
      append(lines_, kind == texture ? "texture coordinate" : axes[static_cast<std::size_t>(i)]);
    file_.content += '\n';
    ++count_[kind];
  }

  // The word itself, so that nothing is lost before OpenMesh rounds it.
  void append(TextLines& lines, const char* what) {
    TextLines ahead = lines;
    lines.number(what);
    file_.content += ' ';
    file_.content += ahead.word();
  }

  void read_face() {
    polygon_.clear();
    file_.content += 'f';
    int form = -1;
    for (std::string_view word = lines_.word(); !word.empty(); word = lines_.word()) {
      const int corner_form = read_corner(word);
      if (form >= 0 && corner_form != form) lines_.fail("the corners of a face differ in form");
      form = corner_form;
    }
    file_.content += '\n';
    // Vertices that come later in the file count as well; run() checks that they came.
    const std::string fault = polygon_fault(polygon_, 1, std::max(count_[position], largest_[position]));
    if (!fault.empty()) lines_.fail(fault);
    ++file_.polygons;
  }

  // "v", "v/t", "v//n" or "v/t/n"; the result tells which.
  int read_corner(std::string_view word) {
    const std::string_view whole = word;
    int form = 0;
    for (int kind = position; kind < kinds; ++kind) {
      const std::size_t slash = word.find('/');
      const std::string_view part = word.substr(0, slash);
      if (!part.empty()) {
        file_.content += kind == position ? " " : kind == texture ? "/" : form & 2 ? "/" : "//";
        read_index(static_cast<Kind>(kind), part);
        form |= 1 << kind;
      }
      if (slash == std::string_view::npos) {
        word = {};
        if (!part.empty() || kind == position) break;
        lines_.fail("a face has the corner '" + std::string(whole) + "'");
      }
      word.remove_prefix(slash + 1);
    }
    if (!word.empty() || !(form & 1)) lines_.fail("a face has the corner '" + std::string(whole) + "'");
    return form;
  }

  void read_index(Kind kind, std::string_view word) {
    const std::optional<long long> value = to_integer(word);
    if (!value) lines_.fail("a face has the index '" + std::string(word) + "'");
    const long long index = *value < 0 ? count_[kind] + 1 + *value : *value;
    if (index < 1)
      lines_.fail(std::string("a face names ") + names[kind] + " " + std::to_string(*value) + " of " +
                  std::to_string(count_[kind]));
    // The first reference beyond the end is also the largest until then, so that the others need no record.
    if (index > std::max(count_[kind], largest_[kind])) {
      largest_[kind] = index;
      forward_.push_back({kind, index, lines_});
    }
    if (kind == position) polygon_.push_back(index);
    file_.content += std::to_string(index);
  }

  [[noreturn]] void fail(const ForwardReference& reference) const {
    reference.lines.fail(std::string("a face names ") + names[reference.kind] + " " +
                         std::to_string(reference.index) + " of " + std::to_string(count_[reference.kind]));
  }

  std::filesystem::path path_;
  TextLines lines_;
  MeshFile file_;
  std::array<long long, kinds> count_{};
  std::array<long long, kinds> largest_{};
  std::vector<ForwardReference> forward_;
  std::vector<long long> polygon_;
};

}  // namespace

MeshFile check_obj(const std::filesystem::path& path, const std::string& content) {
  return ObjCheck(path, content).run();
}

}  // namespace bespoke
