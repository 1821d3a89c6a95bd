#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bespoke/error.h"

namespace bespoke {

/// Walks through the lines of a text, and through the words of a line. A '#' begins a comment.
class TextLines {
 public:
  /// `path` is for messages only. A backslash at the end of a line joins the next one where `joins` says so.
  TextLines(std::filesystem::path path, std::string_view text, bool joins = false)
      : path_(std::move(path)), text_(text), joins_(joins) {}

  /// Goes to the next line; false at the end.
  bool next();
  /// Goes to the next line that has a word; false at the end.
  bool next_with_words();

  /// The line's next word, empty when there is none.
  std::string_view word();
  /// The line's next word as a finite number in a float's range. `what` is for the message.
  double number(const char* what);
  /// The line's next word as a whole number.
  long long integer(const char* what);

  std::size_t offset() const { return end_; }             ///< in the text, of the next line
  [[noreturn]] void fail(const std::string& what) const;  ///< FormatError "path:line: what"

 private:
  std::filesystem::path path_;
  std::string_view text_;
  bool joins_;
  std::size_t at_ = 0, line_end_ = 0, end_ = 0;
  std::size_t line_ = 0, lines_ahead_ = 1;
};

/// All of the word as a number: no value when it is none. "nan" and "inf" are numbers here.
std::optional<double> to_number(std::string_view word);
std::optional<long long> to_integer(std::string_view word);

/// What is wrong with a polygon of vertices numbered [first, first + vertices): fewer than three corners, an
/// index out of range, or one that occurs twice. Empty when nothing is.
std::string polygon_fault(std::vector<long long> polygon, long long first, long long vertices);

}  // namespace bespoke
