#include "bespoke/text_lines.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>

#include "bespoke/error.h"

namespace bespoke {
namespace {

/// The name of an encoding of two or four bytes a character; empty for a text of bytes.
std::string_view wide_encoding(std::string_view head) {
  using namespace std::string_view_literals;
  for (const std::string_view mark : {"\xFF\xFE\0\0"sv, "\0\0\xFE\xFF"sv})
    if (head.starts_with(mark)) return "UTF-32";
  for (const std::string_view mark : {"\xFF\xFE"sv, "\xFE\xFF"sv})
    if (head.starts_with(mark)) return "UTF-16";
  // Without a mark: characters of ASCII, of which every second byte is zero.
  constexpr std::size_t examined = 8;
  if (head.size() < examined) return "";
  std::size_t zeros[2] = {0, 0};
  for (std::size_t i = 0; i < examined; ++i) zeros[i % 2] += head[i] == '\0';
  const bool is_wide = zeros[0] + zeros[1] == examined / 2 && std::max(zeros[0], zeros[1]) == examined / 2;
  return is_wide ? "UTF-16" : "";
}

}  // namespace

std::string_view without_byte_order_mark(std::string_view text) {
  return text.substr(text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0);
}

void require_utf8(std::string_view head, const std::filesystem::path& path) {
  const std::string_view encoding = wide_encoding(head);
  if (!encoding.empty())
    throw FormatError(path.string() + ": is " + std::string(encoding) + "; save as UTF-8");
}

// A file may have no break of the one kind, so neither is looked for to the end of the block.
const char* line_break(const char* from, const char* end) {
  constexpr std::ptrdiff_t examined = 128;  // bytes at a time, more than most lines have
  while (from != end) {
    const char* const limit = from + std::min(examined, end - from);
    const auto find = [&](char c, const char* until) {
      const void* const found = std::memchr(from, c, static_cast<std::size_t>(until - from));
      return found ? static_cast<const char*>(found) : until;
    };
    const char* const found = find('\r', find('\n', limit));
    if (found != limit) return found;
    from = limit;
  }
  return end;
}

const char* behind_line_break(const char* at, const char* end) {
  if (at == end) return end;
  return at + (*at == '\r' && at + 1 != end && at[1] == '\n' ? 2 : 1);
}

std::size_t count_line_breaks(std::string_view text) {
  auto breaks = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  if (text.find('\r') == std::string_view::npos) return breaks;
  for (std::size_t i = 0; i < text.size(); ++i)
    breaks += text[i] == '\r' && (i + 1 == text.size() || text[i + 1] != '\n');
  return breaks;
}

std::string_view first_line_break(std::string_view text) {
  const char* const end = text.data() + text.size();
  const char* const at = line_break(text.data(), end);
  if (at == end) return "\n";
  return {at, static_cast<std::size_t>(behind_line_break(at, end) - at)};
}

std::vector<std::string_view> text_lines(std::string_view text) {
  text = without_byte_order_mark(text);
  std::vector<std::string_view> lines;
  const char* const end = text.data() + text.size();
  for (const char* at = text.data(); at != end;) {
    const char* const found = line_break(at, end);
    lines.emplace_back(at, static_cast<std::size_t>(found - at));
    at = behind_line_break(found, end);
  }
  return lines;
}

std::string read_text_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    throw FileError(path.string() + ": cannot be opened for reading");
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) throw FileError(path.string() + ": reading failed");
  require_utf8(text, path);
  if (text.starts_with(byte_order_mark)) text.erase(0, byte_order_mark.size());
  return text;
}

}  // namespace bespoke
