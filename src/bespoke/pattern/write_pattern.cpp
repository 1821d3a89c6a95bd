#include "bespoke/pattern/write_pattern.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "bespoke/atomic_file.h"
#include "bespoke/error.h"
#include "bespoke/pattern/sheet/sheet_formats.h"
#include "bespoke/strings.h"
#include "bespoke/unknown_ending.h"

namespace bespoke {
namespace {

constexpr std::array of_sheets{".svg", ".dxf", ".pdf"};
constexpr std::array of_patterns{".svg", ".dxf", ".pdf", ".json", ".glb"};

template <class Endings>
bool is_among(const Endings& endings, const std::filesystem::path& path) {
  const std::string ending = lower_ending(path);
  return std::any_of(endings.begin(), endings.end(), [&](const char* known) { return ending == known; });
}

void write_whole(const std::filesystem::path& path, const std::string& text) {
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << text;
    out.close();
    if (!out) throw FileError(path.string() + ": cannot be written");
  });
}

[[noreturn]] void refuse_ending(const std::filesystem::path& path, const std::string& known) {
  throw UnknownEnding(path.string() + ": its name must end in " + known);
}

}  // namespace

std::string millimetres(double value) {
  char text[48];
  std::snprintf(text, sizeof text, "%.4f", value);
  std::string number = text;
  while (number.back() == '0') number.pop_back();
  if (number.back() == '.') number.pop_back();
  return number == "-0" ? "0" : number;
}

std::string identifier(const std::string& name) {
  std::string result;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0)
      result += static_cast<char>(std::tolower(byte));
    else if (!result.empty() && result.back() != '-')
      result += '-';
  }
  while (!result.empty() && result.back() == '-') result.pop_back();
  if (result.empty() || std::isdigit(static_cast<unsigned char>(result.front())) != 0) result = "p" + result;
  return result;
}

Eigen::Vector3d strain_colour(double strain) {
  const double share = std::clamp(strain / red_strain, 0.0, 1.0);
  return {1, 1 - share, 1 - share};
}

Eigen::Vector2d sheet_shift(const PatternPiece& piece, const SheetPiece& drawn) {
  return drawn.outline.col(0) - piece.flat.col(piece.piece.outline.front());
}

std::string sheet_endings() { return alternatives({of_sheets.begin(), of_sheets.end()}); }
std::string pattern_endings() { return alternatives({of_patterns.begin(), of_patterns.end()}); }
bool can_write_sheet(const std::filesystem::path& path) { return is_among(of_sheets, path); }
bool can_write_pattern(const std::filesystem::path& path) { return is_among(of_patterns, path); }

void write_sheet(const std::filesystem::path& path, const Sheet& sheet, const PatternFileOptions& options) {
  const std::string ending = lower_ending(path);
  if (ending == ".svg") return write_whole(path, svg_text(sheet, options));
  if (ending == ".dxf") return write_whole(path, dxf_text(sheet, options));
  if (ending != ".pdf") refuse_ending(path, sheet_endings());
  write_atomically(
      path, [&](const std::filesystem::path& temporary) { write_pdf_sheet(temporary, sheet, options); });
}

void write_pattern(const std::filesystem::path& path, const FlatPattern& pattern, const Sheet& sheet,
                   const PatternFileOptions& options) {
  const std::string ending = lower_ending(path);
  if (ending == ".json") return write_whole(path, pattern_json(pattern, sheet, options));
  if (ending == ".glb") return write_glb_pieces(path, pattern, sheet, options);
  if (!can_write_sheet(path)) refuse_ending(path, pattern_endings());
  write_sheet(path, sheet, options);
}

}  // namespace bespoke
