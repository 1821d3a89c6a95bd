#include "bespoke/mesh/detail/text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace bespoke {
namespace {

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f' || c == '\\';
}

template <class Value>
std::optional<Value> parse(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  Value value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

// Long or unprintable words would spoil a message of one line.
std::string quoted(std::string_view word) {
  std::string text = "'";
  for (const char c : word.substr(0, 40)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > 40 ? "…'" : "'");
}

}  // namespace

std::optional<double> to_number(std::string_view word) { return parse<double>(word); }
std::optional<long long> to_integer(std::string_view word) { return parse<long long>(word); }

bool TextLines::next() {
  line_ += lines_ahead_;
  lines_ahead_ = 1;
  at_ = end_;
  if (at_ >= text_.size()) return false;
  for (std::size_t from = at_;; ++lines_ahead_) {
    const std::size_t newline = text_.find('\n', from);
    line_end_ = std::min(newline, text_.size());
    end_ = std::min(line_end_ + 1, text_.size());
    if (!joins_ || end_ == text_.size()) break;
    const std::size_t last = text_.find_last_not_of("\r\n", line_end_);
    if (last == std::string_view::npos || last < from || text_[last] != '\\') break;
    from = end_;
  }
  const std::size_t comment = text_.substr(at_, line_end_ - at_).find('#');
  if (comment != std::string_view::npos) line_end_ = at_ + comment;
  return true;
}

bool TextLines::next_with_words() {
  while (next()) {
    while (at_ < line_end_ && is_space(text_[at_])) ++at_;
    if (at_ < line_end_) return true;
  }
  return false;
}

std::string_view TextLines::word() {
  while (at_ < line_end_ && is_space(text_[at_])) ++at_;
  const std::size_t begin = at_;
  while (at_ < line_end_ && !is_space(text_[at_])) ++at_;
  return text_.substr(begin, at_ - begin);
}

double TextLines::number(const char* what) {
  const std::string_view text = word();
  if (text.empty()) fail(std::string("missing ") + what);
  const std::optional<double> value = to_number(text);
  if (!value) fail(std::string(what) + ": " + quoted(text) + " is not a number");
  if (!(std::abs(*value) <= static_cast<double>(std::numeric_limits<float>::max())))
    fail(std::string(what) + ": " + quoted(text) + " is not finite in single precision");
  return *value;
}

long long TextLines::integer(const char* what) {
  const std::string_view text = word();
  if (text.empty()) fail(std::string("missing ") + what);
  const std::optional<long long> value = to_integer(text);
  if (!value) fail(std::string(what) + ": " + quoted(text) + " is not a whole number");
  return *value;
}

void TextLines::fail(const std::string& what) const {
  throw FormatError(path_.string() + ":" + std::to_string(line_) + ": " + what);
}

std::string polygon_fault(std::vector<long long> polygon, long long first, long long vertices) {
  if (polygon.size() < 3) return "a face of " + std::to_string(polygon.size()) + " corners";
  for (const long long vertex : polygon)
    if (!(vertex >= first && vertex < first + vertices))
      return "a face names vertex " + std::to_string(vertex) + ", outside " + std::to_string(first) + " … " +
             std::to_string(first + vertices - 1);
  std::sort(polygon.begin(), polygon.end());
  const auto twice = std::adjacent_find(polygon.begin(), polygon.end());
  return twice == polygon.end() ? "" : "a face names vertex " + std::to_string(*twice) + " twice";
}

}  // namespace bespoke
