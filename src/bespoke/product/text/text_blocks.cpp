#include "bespoke/product/text/text_blocks.h"

#include <algorithm>

#include "bespoke/error.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

constexpr std::size_t block_size = std::size_t{1} << 20;

// No statement of a text format is near as long; a file without line breaks is none.
constexpr std::size_t longest_line = std::size_t{1} << 28;

/// Whether the line break at `at` of lines that begin at `begin` has a backslash before it.
bool is_continued(const char* begin, const char* at) { return at > begin && at[-1] == '\\'; }

bool is_break(char c) { return c == '\n' || c == '\r'; }

}  // namespace

std::size_t TextCutter::block_end(std::string_view bytes, bool is_last) const {
  const char* const begin = bytes.data();
  const char* const end = begin + bytes.size();
  const char* from = begin + std::min(block_size, bytes.size());
  if (from != end && *from == '\n' && from[-1] == '\r') --from;
  while (from != end) {
    const char* const at = line_break(from, end);
    from = behind_line_break(at, end);
    // What follows a last CR is not known yet.
    if (at == end || (from == end && *at == '\r')) break;
    if (is_continued(begin, at)) continue;
    if (ends_block_) {
      const char* line = at;
      while (line > begin && !is_break(line[-1])) --line;
      if (!ends_block_({line, static_cast<std::size_t>(at - line)})) continue;
    }
    return static_cast<std::size_t>(from - begin);
  }
  return is_last ? bytes.size() : 0;
}

std::vector<TextBlock> TextCutter::operator()(const Window& window) {
  std::vector<TextBlock> blocks;
  std::string_view rest = window.bytes;
  while (!rest.empty()) {
    const std::size_t size = block_end(rest, window.is_last);
    if (size == 0) break;
    next_.bytes = rest.substr(0, size);
    blocks.push_back(next_);
    next_.line += count_line_breaks(next_.bytes);
    if (count_) count_(next_.bytes, next_.before);
    rest.remove_prefix(size);
  }
  if (blocks.empty() && rest.size() > longest_line)
    throw FormatError(path_.string() + ":" + std::to_string(next_.line) + ": a line of more than " +
                      std::to_string(longest_line >> 20) + " MB");
  return blocks;
}

bool TextWords::next_line() {
  const char* const end = block_.bytes.data() + block_.bytes.size();
  while (end_ != end) {
    at_ = end_;
    line_end_ = line_break(at_, end);
    skip_blanks();
    if (std::string_view(at_, static_cast<std::size_t>(line_end_ - at_)).starts_with(byte_order_mark)) {
      at_ += byte_order_mark.size();
      skip_blanks();
    }
    const bool is_comment = syntax_.comment != 0 && at_ != line_end_ && *at_ == syntax_.comment;
    if (syntax_.continues && !is_comment)
      while (line_end_ != end && is_continued(end_, line_end_)) {
        line_end_ = line_break(behind_line_break(line_end_, end), end);
        skip_blanks();
      }
    end_ = behind_line_break(line_end_, end);
    if (at_ == line_end_ || (syntax_.comment != 0 && *at_ == syntax_.comment)) continue;
    begin_ = at_;
    return true;
  }
  return false;
}

// Words are most of the work on a text, and a table is faster than comparisons.
const TextWords::Characters& TextWords::characters_behind_words(LineSyntax syntax) {
  static const auto tables = [] {
    std::array<Characters, 12> all{};
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t c = 0; c <= ' '; ++c) all[i][c] = true;
      all[i]['#'] = i % 2 == 1;
      all[i]['\\'] = i / 2 % 2 == 1;
      if (i / 4 > 0) all[i][i / 4 == 1 ? ',' : ';'] = true;
    }
    return all;
  }();
  const std::size_t separator = syntax.separator == ',' ? 1 : syntax.separator == ';' ? 2 : 0;
  return tables[4 * separator + (syntax.continues ? 2u : 0u) + (syntax.comment != 0 ? 1u : 0u)];
}

std::string_view TextWords::word() {
  skip_blanks();
  const char* const begin = at_;
  while (at_ != line_end_ && !ends_word_[static_cast<unsigned char>(*at_)]) ++at_;
  if (at_ != line_end_ && syntax_.comment != 0 && *at_ == syntax_.comment) line_end_ = at_;
  return {begin, static_cast<std::size_t>(at_ - begin)};
}

NumberText TextWords::number(const char* what) {
  const std::string_view text = word();
  if (text.empty()) fail(std::string("missing ") + what);
  NumberText number;
  if (!read_number(text, syntax_.point, number))
    fail(std::string(what) + ": " + in_quotes(text) + " is not a finite number");
  return number;
}

long long TextWords::integer(const char* what) {
  const std::string_view text = word();
  if (text.empty()) fail(std::string("missing ") + what);
  long long value = 0;
  if (!read_integer(text.data(), text.data() + text.size(), value))
    fail(std::string(what) + ": " + in_quotes(text) + " is not a whole number");
  return value;
}

std::string TextWords::place() const {
  const char* const begin = block_.bytes.data();
  const char* const at = begin_ ? begin_ : begin;
  const std::size_t line = block_.line + count_line_breaks({begin, static_cast<std::size_t>(at - begin)});
  return path_.string() + ":" + std::to_string(line);
}

void TextWords::fail(const std::string& what) const { throw FormatError(place() + ": " + what); }

std::function<void(std::string_view, std::array<std::uint64_t, 3>&)> line_counter(LineSyntax syntax) {
  return [syntax](std::string_view lines, std::array<std::uint64_t, 3>& sums) {
    TextBlock block;
    block.bytes = lines;
    const std::filesystem::path unnamed;
    TextWords words(block, unnamed, syntax);
    while (words.next_line()) ++sums[0];
  };
}

std::string in_quotes(std::string_view word) {
  std::string text = "'";
  for (const char c : word.substr(0, 40)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > 40 ? "…'" : "'");
}

}  // namespace bespoke
