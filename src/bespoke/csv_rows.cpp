#include "bespoke/csv_rows.h"

#include <algorithm>
#include <array>

namespace bespoke {
namespace {

constexpr std::array separators{',', ';', '\t'};

std::string_view without_blanks(std::string_view text) {
  constexpr const char* blanks = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

// A quote within a cell that does not begin with one is a character: 5" wide.
CsvRow csv_row(std::string_view line, char separator) {
  CsvRow row;
  bool is_quoted = false, is_at_begin = true;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && (is_quoted || is_at_begin)) {
      is_quoted = !is_quoted;
      // A doubled quote closes and opens at once.
      is_at_begin = !is_quoted && i + 1 < line.size() && line[i + 1] == '"';
    } else if (c == separator && !is_quoted) {
      row.cells.push_back(without_blanks(line.substr(begin, i - begin)));
      begin = i + 1;
      is_at_begin = true;
    } else if (c != ' ' && c != '\t') {
      is_at_begin = false;
    }
  }
  row.cells.push_back(without_blanks(line.substr(begin)));
  row.is_closed = !is_quoted;
  return row;
}

std::string csv_text(std::string_view cell) {
  if (!cell.starts_with('"')) return std::string(cell);
  std::string text;
  bool is_quoted = true;
  for (std::size_t i = 1; i < cell.size(); ++i) {
    if (cell[i] != '"' || !is_quoted)
      text += cell[i];
    else if (i + 1 < cell.size() && cell[i + 1] == '"')
      text += cell[i++];
    else
      is_quoted = false;
  }
  return text;
}

std::vector<std::string> csv_texts(const CsvRow& row) {
  std::vector<std::string> texts;
  for (const std::string_view cell : row.cells) texts.push_back(csv_text(cell));
  return texts;
}

std::string_view csv_characters(std::string_view cell) {
  if (cell.size() > 1 && cell.starts_with('"') && cell.ends_with('"')) cell = cell.substr(1, cell.size() - 2);
  return without_blanks(cell);
}

std::optional<char> csv_separator(std::string_view line,
                                  const std::function<bool(const std::vector<std::string>&)>& accepts) {
  const auto found = std::find_if(separators.begin(), separators.end(), [&](char separator) {
    const CsvRow row = csv_row(line, separator);
    return row.is_closed && accepts(csv_texts(row));
  });
  return found == separators.end() ? std::nullopt : std::optional(*found);
}

std::optional<char> csv_named_separator(std::string_view line) {
  constexpr std::string_view begin = "sep=";
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  if (line.size() != begin.size() + 1 || !line.starts_with(begin)) return std::nullopt;
  const char named = line.back();
  return std::find(separators.begin(), separators.end(), named) == separators.end() ? std::nullopt
                                                                                    : std::optional(named);
}

bool has_decimal_comma(std::string_view text) {
  const std::size_t comma = text.find(',');
  return comma != std::string_view::npos && comma > 0 && comma + 1 < text.size() &&
         is_digit(text[comma - 1]) && is_digit(text[comma + 1]) &&
         text.find(',', comma + 1) == std::string_view::npos && text.find('.') == std::string_view::npos;
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",;\t\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace bespoke
