#include "bespoke/product/detail/text_blocks.h"

#include <algorithm>
#include <cstring>

#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr std::size_t block_size = std::size_t{1} << 20;

// No statement of a text format is near as long; a file without line breaks is none.
constexpr std::size_t longest_line = std::size_t{1} << 28;

const char* line_break(const char* from, const char* end) {
  const void* found = std::memchr(from, '\n', static_cast<std::size_t>(end - from));
  return found ? static_cast<const char*>(found) : end;
}

/// Whether the line break at `newline` of lines that begin at `begin` has a backslash before it.
bool is_continued(const char* begin, const char* newline) {
  const char* last = newline;
  while (last > begin && last[-1] == '\r') --last;
  return last > begin && last[-1] == '\\';
}

}  // namespace

std::size_t TextCutter::block_end(std::string_view bytes, bool is_last) const {
  const char* const begin = bytes.data();
  const char* const end = begin + bytes.size();
  for (const char* from = begin + std::min(block_size, bytes.size()); from != end;) {
    const char* const newline = line_break(from, end);
    if (newline == end) break;
    from = newline + 1;
    if (is_continued(begin, newline)) continue;
    if (ends_block_) {
      const char* line = newline;
      while (line > begin && line[-1] != '\n') --line;
      if (!ends_block_({line, static_cast<std::size_t>(newline - line)})) continue;
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
    next_.line += static_cast<std::size_t>(std::count(next_.bytes.begin(), next_.bytes.end(), '\n'));
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
    while (at_ != line_end_ && is_blank(*at_)) ++at_;
    const bool is_comment = syntax_.comment != 0 && at_ != line_end_ && *at_ == syntax_.comment;
    if (syntax_.continues && !is_comment)
      while (line_end_ != end && is_continued(end_, line_end_)) {
        line_end_ = line_break(line_end_ + 1, end);
        while (at_ != line_end_ && is_blank(*at_)) ++at_;
      }
    end_ = line_end_ == end ? end : line_end_ + 1;
    if (at_ == line_end_ || (syntax_.comment != 0 && *at_ == syntax_.comment)) continue;
    begin_ = at_;
    return true;
  }
  return false;
}

// Words are most of the work on a text, and a table is faster than comparisons.
const TextWords::Characters& TextWords::characters_behind_words(LineSyntax syntax) {
  const auto table = [](bool continues, char comment) {
    Characters characters{};
    for (std::size_t c = 0; c <= ' '; ++c) characters[c] = true;
    characters['\\'] = continues;
    if (comment != 0) characters[static_cast<unsigned char>(comment)] = true;
    return characters;
  };
  static const std::array tables{table(false, 0), table(false, '#'), table(true, 0), table(true, '#')};
  return tables[(syntax.continues ? 2u : 0u) + (syntax.comment != 0 ? 1u : 0u)];
}

std::string_view TextWords::word() {
  while (at_ != line_end_ && is_blank(*at_)) ++at_;
  const char* const begin = at_;
  while (at_ != line_end_ && !ends_word_[static_cast<unsigned char>(*at_)]) ++at_;
  if (at_ != line_end_ && syntax_.comment != 0 && *at_ == syntax_.comment) line_end_ = at_;
  return {begin, static_cast<std::size_t>(at_ - begin)};
}

NumberText TextWords::number(const char* what) {
  const std::string_view text = word();
  if (text.empty()) fail(std::string("missing ") + what);
  NumberText number;
  if (!read_number(text.data(), text.data() + text.size(), number))
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

void TextWords::fail(const std::string& what) const {
  const char* const begin = block_.bytes.data();
  const char* const at = begin_ ? begin_ : begin;
  const auto line = block_.line + static_cast<std::size_t>(std::count(begin, at, '\n'));
  throw FormatError(path_.string() + ":" + std::to_string(line) + ": " + what);
}

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
