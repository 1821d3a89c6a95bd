#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/product/carry/directions.h"
#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/faces/face_parts.h"
#include "bespoke/product/off/off_text.h"
#include "bespoke/product/text/split_numbers.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

using OffRecord = std::vector<SplitNumber>;

/// Vertices, faces and edges, as the header counts them.
constexpr std::size_t off_counts = 3;

class OffSplitter {
 public:
  OffSplitter(const InputFile& file, std::string_view text, const FaceSplits& splits)
      : text_(text),
        header_(read_off_header(file)),
        splits_(splits),
        parts_(splits, header_.faces, file.path()),
        line_break_(first_line_break(text)) {
    body_.bytes = text.substr(header_.size);
    body_.line = header_.lines + 1;
    decimals_ = position_decimals(OffText(file.path(), header_).records(body_).points);
    TextWords words(body_, file.path());
    while (words.next_line()) {
      std::vector<std::string_view>& own = lines_.emplace_back();
      for (std::string_view word = words.word(); !word.empty(); word = words.word()) own.push_back(word);
      if (lines_.size() == header_.vertices) vertices_end_ = words.line_end();
    }
    has_whole_colours_ = are_colours_whole();
  }

  std::string run() {
    std::vector<TextEdit> faces;
    for (std::size_t face = 0; face < header_.faces; ++face)
      add_face(lines_[header_.vertices + face], face, faces);
    std::vector<TextEdit> edits = repaired_counts();
    edits.push_back({{vertices_end_, 0}, made_vertices()});
    edits.insert(edits.end(), faces.begin(), faces.end());
    return edited(text_, {}, std::move(edits));
  }

 private:
  std::string made_vertices() const {
    std::vector<OffRecord> made;
    const auto record = [&](int vertex) {
      const auto i = static_cast<std::size_t>(vertex);
      return i < header_.vertices ? record_of(lines_[i]) : made[i - header_.vertices];
    };
    std::string text;
    for (const auto& [a, b] : splits_.vertices) {
      made.push_back(middle(record(a), record(b)));
      for (std::size_t k = 0; k < made.back().size(); ++k) {
        if (k > 0) text += ' ';
        append_number(text, made.back()[k], is_whole(k, made.back().size()));
      }
      text += line_break_;
    }
    return text;
  }

  static OffRecord record_of(const std::vector<std::string_view>& words) {
    OffRecord record;
    for (const std::string_view word : words) record.push_back(split_number(word));
    return record;
  }

  OffRecord middle(const OffRecord& a, const OffRecord& b) const {
    OffRecord middle;
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
      middle.push_back(middle_number(a[k], b[k], is_whole(k, a.size())));
    for (std::size_t axis = 0; axis < 3; ++axis) middle[axis].decimals = decimals_;
    if (!header_.has_normals) return middle;
    const Vector3 normal = middle_direction(normal_of(a), normal_of(b));
    for (std::size_t axis = 0; axis < 3; ++axis)
      middle[3 + axis].value = normal[static_cast<Eigen::Index>(axis)];
    return middle;
  }

  static Vector3 normal_of(const OffRecord& record) {
    return {record[3].value, record[4].value, record[5].value};
  }

  /// A vertex is a position, a normal, a colour and a texture coordinate, as far as the file has them. Whole
  /// colours are those of which none has a point.
  bool are_colours_whole() const {
    return std::all_of(
        lines_.begin(), lines_.begin() + static_cast<std::ptrdiff_t>(header_.vertices),
        [&](const std::vector<std::string_view>& words) {
          for (std::size_t k = 0; k < words.size(); ++k)
            if (is_colour(k, words.size()) && words[k].find_first_of(".eE") != std::string_view::npos)
              return false;
          return true;
        });
  }
  bool is_colour(std::size_t k, std::size_t words) const {
    return k >= (header_.has_normals ? 6u : 3u) && k + (header_.has_texture ? 2 : 0) < words;
  }
  bool is_whole(std::size_t k, std::size_t words) const { return has_whole_colours_ && is_colour(k, words); }

  /// A face's words are the number of its corners, these, and its colour.
  void add_face(const std::vector<std::string_view>& words, std::size_t face, std::vector<TextEdit>& edits) {
    const auto corners = static_cast<std::ptrdiff_t>(split_number(words.front()).value);
    const auto colour = words.begin() + 1 + corners;
    std::vector<int> own;
    for (auto word = words.begin() + 1; word != colour; ++word)
      own.push_back(static_cast<int>(split_number(*word).value));
    const auto middle = [](int, int, int vertex) { return vertex; };
    std::string text;
    for (const std::vector<int>& part : parts_.parts(face, own, middle)) {
      if (!text.empty()) text += line_break_;
      text += std::to_string(part.size());
      for (const int vertex : part) text.append(" ").append(std::to_string(vertex));
      for (auto word = colour; word != words.end(); ++word) text.append(" ").append(*word);
      add_edges(part);
    }
    const char* const begin = words.front().data();
    const char* const end = words.back().data() + words.back().size();
    if (parts_.is_split(face))
      edits.push_back({{begin, static_cast<std::size_t>(end - begin)}, std::move(text)});
  }

  void add_edges(const std::vector<int>& part) {
    for (std::size_t k = 0; k < part.size(); ++k)
      edges_.push_back(std::minmax({part[k], part[(k + 1) % part.size()]}));
  }

  /// The number of edges may be missing, or 0 where they were not counted.
  std::vector<TextEdit> repaired_counts() {
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    const std::array<std::size_t, off_counts> now{
        static_cast<std::size_t>(header_.vertices) + splits_.vertices.size(), parts_.count(), edges_.size()};
    TextBlock line;
    line.bytes = text_.substr(header_.counts, header_.size - header_.counts);
    const std::filesystem::path read_before;
    TextWords words(line, read_before);
    words.next_line();
    std::vector<TextEdit> edits;
    for (const std::size_t count : now)
      if (const std::string_view word = words.word(); !word.empty() && word != "0")
        edits.push_back({word, std::to_string(count)});
    return edits;
  }

  std::string_view text_;
  const OffHeader header_;
  const FaceSplits& splits_;
  FaceParts parts_;
  std::string line_break_;
  TextBlock body_;
  int decimals_ = 0;  // of new coordinates
  bool has_whole_colours_ = false;
  std::vector<std::vector<std::string_view>> lines_;  // the words of vertices and faces
  const char* vertices_end_ = nullptr;
  std::vector<std::pair<int, int>> edges_;
};

}  // namespace

void split_off(const InputFile& file, const FaceSplits& splits, OutputFile& output) {
  const std::string text = file.content();
  output.write(OffSplitter(file, text, splits).run());
}

}  // namespace bespoke
