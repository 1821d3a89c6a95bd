#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "bespoke/product/text/block_walk.h"
#include "bespoke/product/text/number_text.h"

namespace bespoke {

/// Whole lines of a text file.
struct TextBlock {
  std::string_view bytes;
  std::size_t line = 1;                   ///< number of its first line in the file
  std::array<std::uint64_t, 3> before{};  ///< how many of what its format counts lie before it
};

/// Cuts a text file into blocks of about a megabyte. A line that ends in a backslash stays with the next.
class TextCutter {
 public:
  /// `count` adds what whole lines hold to the sums that blocks know of those before them; `ends_block` says
  /// of a line whether a block may end behind it. Both may be empty.
  TextCutter(std::filesystem::path path, std::size_t first_line,
             std::function<void(std::string_view lines, std::array<std::uint64_t, 3>& sums)> count,
             std::function<bool(std::string_view line)> ends_block = {})
      : path_(std::move(path)), count_(std::move(count)), ends_block_(std::move(ends_block)) {
    next_.line = first_line;
  }

  std::vector<TextBlock> operator()(const Window& window);

  /// Sums over all blocks so far.
  const std::array<std::uint64_t, 3>& sums() const { return next_.before; }

 private:
  std::size_t block_end(std::string_view bytes, bool is_last) const;

  std::filesystem::path path_;
  std::function<void(std::string_view, std::array<std::uint64_t, 3>&)> count_;
  std::function<bool(std::string_view)> ends_block_;
  TextBlock next_;  ///< its line and sums are those of the next block
};

/// How a format writes its lines.
struct LineSyntax {
  char comment = '#';      ///< begins a comment up to the end of the line; 0 for none
  bool continues = false;  ///< a backslash at the end of a line, but of a comment, joins the next one
  char separator = 0;      ///< a comma or a semicolon that is a blank; 0 for none
  char point = '.';        ///< in numbers, or a comma
};

/// Walks through the lines of a block, and through the words of a line. A byte order mark at the beginning of
/// a line is a blank: files that begin with one are joined to others.
class TextWords {
 public:
  /// The block and the path must outlive the iteration.
  TextWords(const TextBlock& block, const std::filesystem::path& path, LineSyntax syntax = {})
      : block_(block),
        path_(path),
        syntax_(syntax),
        ends_word_(characters_behind_words(syntax)),
        end_(block.bytes.data()),
        line_end_(end_) {}

  /// Goes to the next line that has a word; false at the end.
  bool next_line();
  /// The line's next word, empty when there is none.
  std::string_view word();
  /// The line's next word as a finite number.
  NumberText number(const char* what);
  long long integer(const char* what);

  const char* line_begin() const { return begin_; }  ///< of the line's first word
  const char* line_end() const { return end_; }      ///< behind its line break

  /// "path:line" of the last word.
  std::string place() const;
  /// FormatError "path:line: what" for the line of the last word.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  using Characters = std::array<bool, 256>;
  static const Characters& characters_behind_words(LineSyntax syntax);

  bool is_blank(char c) const {
    return static_cast<unsigned char>(c) <= ' ' || (c == '\\' && syntax_.continues) ||
           (c == syntax_.separator && c != 0);
  }
  void skip_blanks() {
    while (at_ != line_end_ && is_blank(*at_)) ++at_;
  }

  const TextBlock& block_;
  const std::filesystem::path& path_;
  LineSyntax syntax_;
  const Characters& ends_word_;
  const char* begin_ = nullptr;
  const char* at_ = nullptr;
  const char* end_;
  const char* line_end_;  ///< without the comment
};

/// For a TextCutter: adds the lines that have a word to the first sum.
std::function<void(std::string_view, std::array<std::uint64_t, 3>&)> line_counter(LineSyntax syntax);

/// A word for a message of one line, in quotes, shortened, without what cannot be printed.
std::string in_quotes(std::string_view word);

}  // namespace bespoke
