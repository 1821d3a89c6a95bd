#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bespoke {

/// Tables as spreadsheets save them (RFC 4180 and its dialects): cells between commas, semicolons or tabs;
/// one in double quotes may hold these, and quotes written twice; numbers may have decimal commas where
/// another character separates cells. All tables are read by these: anchors, fiducials, grades, points,
/// manifests.

struct CsvRow {
  std::vector<std::string_view>
      cells;              ///< as they stand in the line, with their quotes, without blanks around
  bool is_closed = true;  ///< no quote is open where the line ends
};

/// The cells of a line; its line break may be left on.
CsvRow csv_row(std::string_view line, char separator);

/// What a cell says: without the quotes around it, a doubled one once.
std::string csv_text(std::string_view cell);
std::vector<std::string> csv_texts(const CsvRow& row);

/// The characters of a cell without blanks and quotes around them.
std::string_view csv_characters(std::string_view cell);

/// The first of comma, semicolon and tab with which a line has cells that are accepted; none where none does.
std::optional<char> csv_separator(std::string_view line,
                                  const std::function<bool(const std::vector<std::string>&)>& accepts);

/// The separator that a line "sep=;" names, with which some spreadsheets want tables to begin.
std::optional<char> csv_named_separator(std::string_view line);

/// Whether the text is a number with a decimal comma: digits on both sides of one, and no point.
bool has_decimal_comma(std::string_view text);

/// A cell with this text: in quotes where it holds a separator, a quote or a line break.
std::string csv_cell(const std::string& text);

}  // namespace bespoke
