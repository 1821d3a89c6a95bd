#pragma once

#include <functional>
#include <string>
#include <vector>

namespace bespoke::test {

/// A way in which programs write a text that others write with single blanks and LF.
struct TextDialect {
  std::string name;
  std::function<std::string(const std::string&)> of;
};

/// The text with every `c` replaced.
inline std::string with_each(const std::string& text, char c, const std::string& by) {
  std::string result;
  for (const char own : text) result += own == c ? by : std::string(1, own);
  return result;
}

inline const std::string bom = "\xEF\xBB\xBF";

/// Line breaks, byte order marks and ends of files: what every text format has.
inline std::vector<TextDialect> line_dialects() {
  const auto lines_end_with = [](const std::string& line_break) {
    return [line_break](const std::string& text) { return with_each(text, '\n', line_break); };
  };
  const auto mixed = [](const std::string& text) {
    std::string result;
    int line = 0;
    for (const char c : text)
      if (c == '\n')
        result += ++line % 3 == 0 ? "\n" : line % 3 == 1 ? "\r" : "\r\n";
      else
        result += c;
    return result;
  };
  return {
      {"a byte order mark", [](const std::string& text) { return bom + text; }},
      {"CR LF", lines_end_with("\r\n")},
      {"CR", lines_end_with("\r")},
      {"mixed line breaks", mixed},
      {"a byte order mark and CR", [=](const std::string& text) { return bom + lines_end_with("\r")(text); }},
      {"no last line break", [](const std::string& text) { return text.substr(0, text.size() - 1); }},
      {"blanks at its end", [](const std::string& text) { return text + "\n \t\r\n"; }}};
}

/// Of texts whose words are between blanks: tabs, further blanks and blank lines.
inline std::vector<TextDialect> blank_dialects() {
  return {
      {"tabs", [](const std::string& text) { return with_each(text, ' ', "\t"); }},
      {"many blanks", [](const std::string& text) { return with_each(text, ' ', " \t  "); }},
      {"blanks before line breaks", [](const std::string& text) { return with_each(text, '\n', " \t\n"); }},
      {"blank lines", [](const std::string& text) { return with_each(text, '\n', "\n\n"); }}};
}

/// The text in UTF-16, of which it has ASCII characters only.
inline std::string utf16(const std::string& text, bool is_big, bool has_mark) {
  std::string result = !has_mark ? "" : is_big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) result += is_big ? std::string{'\0', c} : std::string{c, '\0'};
  return result;
}

}  // namespace bespoke::test
