#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace bespoke {

/// Texts as the programs of all systems write them: lines end at LF, CR LF or CR, and UTF-8 may begin with a
/// byte order mark.

inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// The text behind its byte order mark, or all of it.
std::string_view without_byte_order_mark(std::string_view text);

/// Throws FormatError "path: is UTF-16; save as UTF-8" for the beginning of a text in UTF-16 or UTF-32, with
/// or without a byte order mark.
void require_utf8(std::string_view head, const std::filesystem::path& path);

/// The first character of the line break behind `from`, or `end`.
const char* line_break(const char* from, const char* end);

/// Behind the line break that begins at `at`; `end` stays.
const char* behind_line_break(const char* at, const char* end);

std::size_t count_line_breaks(std::string_view text);

/// The line break that ends the text's first line; "\n" where it has only one line.
std::string_view first_line_break(std::string_view text);

/// The lines without their line breaks, and without the byte order mark. No empty one behind a last break.
std::vector<std::string_view> text_lines(std::string_view text);

/// All of a text file, without its byte order mark. Throws FileError, and what require_utf8 throws.
std::string read_text_file(const std::filesystem::path& path);

}  // namespace bespoke
