#include <algorithm>
#include <string>

#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/obj/obj_normals.h"
#include "bespoke/product/obj/obj_statements.h"
#include "bespoke/product/text/text_records.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

/// What a block holds that changes.
struct BlockContent {
  struct Corner {
    std::string_view text;                   ///< of the normal's number
    std::uint32_t normal = 0, position = 0;  ///< from 0
    std::uint32_t normals_before = 0;        ///< in the file, of a number that counts back from there
    bool counts_back = false;
  };
  std::vector<NumberTriple> positions, normals;
  std::vector<std::string_view> normal_lines;  ///< whole, from their first word
  std::vector<Corner> corners;
  std::string_view line_break;
};

class BlockReader {
 public:
  BlockReader(const TextBlock& block, const std::filesystem::path& path, bool with_normals, bool with_corners)
      : words_(block, path, obj_syntax), with_normals_(with_normals), with_corners_(with_corners) {
    content_.line_break = first_line_break(block.bytes);
    for (std::size_t kind = 0; kind < 3; ++kind) count_[kind] = static_cast<long long>(block.before[kind]);
  }

  BlockContent run() {
    while (words_.next_line()) {
      const char* const line = words_.line_begin();
      if (!with_corners_ && *line != 'v') continue;
      switch (obj_statement(words_.word())) {
        case ObjStatement::position:
          content_.positions.push_back(read_triple(words_));
          ++count_[0];
          break;
        case ObjStatement::normal:
          ++count_[2];
          if (!with_normals_) break;
          content_.normals.push_back(read_triple(words_));
          content_.normal_lines.emplace_back(line, static_cast<std::size_t>(words_.line_end() - line));
          break;
        case ObjStatement::face:
        case ObjStatement::line:
        case ObjStatement::point:
          if (with_corners_) read_corners();
          break;
        default:
          break;
      }
    }
    return std::move(content_);
  }

 private:
  void read_corners() {
    for (std::string_view word = words_.word(); !word.empty(); word = words_.word()) {
      const std::optional<ObjCorner> corner = read_corner(word);
      if (!corner) words_.fail("the file has changed while it was read");
      if (corner->index[2] == 0) continue;
      content_.corners.push_back({corner->normal, resolved(2, corner->index[2]),
                                  resolved(0, corner->index[0]), static_cast<std::uint32_t>(count_[2]),
                                  corner->index[2] < 0});
    }
  }

  std::uint32_t resolved(std::size_t kind, long long written) const {
    return static_cast<std::uint32_t>((written < 0 ? count_[kind] + 1 + written : written) - 1);
  }

  TextWords words_;
  bool with_normals_, with_corners_;
  std::array<long long, 3> count_{};
  BlockContent content_;
};

class ObjCarrier {
 public:
  ObjCarrier(const InputFile& file, const PointMotion& motion, const Progress& progress)
      : file_(file),
        motion_(motion),
        content_(check_obj_product(file, progress)),
        normals_(file, content_, motion, progress),
        decimals_(position_decimals(content_.box, content_.position_decimals)) {
    for (std::size_t frame = 0; frame < motion.frames; ++frame)
      renumbers_ = renumbers_ || normals_.renumbers(frame);
  }

  std::vector<std::string> carry(const TextBlock& block) const {
    const bool with_normals = !content_.first_use.empty();
    const BlockContent content = BlockReader(block, file_.path(), with_normals, renumbers_).run();
    std::vector<Points> images(motion_.frames);
    if (!content.positions.empty()) images = motion_.images(values(content.positions));
    std::vector<std::vector<Points>> normals(motion_.frames);
    if (!content.normals.empty())
      normals = normals_.moved(static_cast<std::uint32_t>(block.before[2]), values(content.normals));
    std::vector<std::string> texts;
    for (std::size_t frame = 0; frame < motion_.frames; ++frame) {
      std::vector<NumberEdit> numbers;
      std::vector<TextEdit> lines;
      require_finite(images[frame], file_.path());
      add_edits(content.positions, images[frame], decimals_, numbers);
      for (std::size_t i = 0; i < content.normals.size(); ++i)
        add_normal(content, i, normals[frame][i], numbers, lines);
      if (normals_.renumbers(frame))
        for (const BlockContent::Corner& corner : content.corners) add_corner(frame, corner, lines);
      texts.push_back(edited(block.bytes, std::move(numbers), std::move(lines)));
    }
    return texts;
  }

  CarrySummary summary() const {
    CarrySummary summary;
    summary.points = static_cast<std::size_t>(content_.counts[0]);
    summary.directions = static_cast<std::size_t>(content_.counts[2]) - content_.unused_normals;
    if (content_.has_free_form)
      summary.warnings.emplace_back("free-form statements (vp, curv, surf) were left as they are");
    if (content_.degenerate.count > 0) summary.warnings.push_back(to_string(content_.degenerate));
    summary.degenerate = content_.degenerate;
    if (content_.unused_normals > 0)
      summary.warnings.push_back(std::to_string(content_.unused_normals) +
                                 " normals that no face uses were left as they are");
    return summary;
  }

 private:
  void add_normal(const BlockContent& content, std::size_t i, const Points& lines,
                  std::vector<NumberEdit>& numbers, std::vector<TextEdit>& texts) const {
    if (lines.cols() == 0) return;
    if (lines.cols() == 1) return add_edits({content.normals[i]}, lines, normals_.decimals(), numbers);
    TextEdit edit{content.normal_lines[i], ""};
    for (Eigen::Index line = 0; line < lines.cols(); ++line) {
      std::vector<NumberEdit> own;
      add_edits({content.normals[i]}, lines.col(line), normals_.decimals(), own);
      edit.text += edited(edit.old, std::move(own));
      const bool ends_line = edit.text.back() == '\n' || edit.text.back() == '\r';
      if (!ends_line && line + 1 < lines.cols()) edit.text += content.line_break;
    }
    texts.push_back(std::move(edit));
  }

  void add_corner(std::size_t frame, const BlockContent::Corner& corner, std::vector<TextEdit>& texts) const {
    const auto line = static_cast<long long>(normals_.line(frame, corner.normal, corner.position));
    const auto before = static_cast<long long>(normals_.lines_before(frame, corner.normals_before));
    std::string number = std::to_string(corner.counts_back ? line - before : line + 1);
    if (number != corner.text) texts.push_back({corner.text, std::move(number)});
  }

  const InputFile& file_;
  const PointMotion& motion_;
  ObjContent content_;
  ObjNormals normals_;
  int decimals_;
  bool renumbers_ = false;
};

}  // namespace

CarrySummary carry_obj(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress) {
  const ObjCarrier carrier(file, motion, progress);
  TextCutter cutter(file.path(), 1, count_obj);
  walk_blocks(
      {file, 0}, [&](const Window& window) { return cutter(window); },
      [&](const TextBlock& block) { return carrier.carry(block); },
      [&](const TextBlock&, std::vector<std::string>&& texts) {
        for (std::size_t frame = 0; frame < outputs.size(); ++frame) outputs[frame].write(texts[frame]);
      },
      progress);
  return carrier.summary();
}

}  // namespace bespoke
