#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>

#include "bespoke/csv_rows.h"
#include "bespoke/error.h"
#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/text/text_records.h"
#include "bespoke/strings.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

// What a unit vector written with four digits may miss.
constexpr double unit_tolerance = 1e-3;

bool is_unit(const NumberTriple& triple) {
  return std::abs(std::hypot(triple[0].value, triple[1].value, triple[2].value) - 1) <= unit_tolerance;
}

constexpr std::array<const char*, 3> position_names{"x", "y", "z"}, normal_names{"nx", "ny", "nz"};

NumberTriple next_triple(TextWords& words, const std::array<const char*, 3>& names) {
  return {words.number(names[0]), words.number(names[1]), words.number(names[2])};
}

/// "0,5 1,5" is not four numbers between commas: these then stand between all numbers.
bool are_between(char separator, const NumberTriple& numbers) {
  for (std::size_t axis = 0; separator != 0 && axis < 2; ++axis) {
    const char* const end = numbers[axis].begin + numbers[axis].length;
    if (std::find(end, numbers[axis + 1].begin, separator) == numbers[axis + 1].begin) return false;
  }
  return true;
}

/// A point a line: x, y, z, and whatever follows.
class XyzText : public TextFormat {
 public:
  XyzText(const std::filesystem::path& path, LineSyntax syntax, bool with_normals)
      : path_(path), syntax_(syntax), has_normals_(with_normals) {}

  TextCutter cutter() const override { return {path_, 1, {}}; }

  TextRecords records(const TextBlock& block) const override {
    TextRecords records;
    records.point = syntax_.point;
    TextWords words(block, path_, syntax_);
    while (words.next_line()) {
      records.points.push_back(next_triple(words, position_names));
      if (!are_between(syntax_.separator, records.points.back()))
        words.fail(std::string("blanks where '") + syntax_.separator + "' separates numbers in other lines");
      if (!has_normals_) continue;
      records.normals.push_back(next_triple(words, normal_names));
      if (!is_unit(records.normals.back())) not_all_units_ = true;
    }
    return records;
  }

  void require_complete(const std::array<std::uint64_t, 3>&) const override {
    if (not_all_units_)
      throw FormatError(path_.string() +
                        ": the numbers behind x, y, z are normals in the first lines but not in all");
  }

 private:
  const std::filesystem::path& path_;
  LineSyntax syntax_;
  bool has_normals_;
  mutable std::atomic<bool> not_all_units_ = false;
};

/// The whole lines of a file's beginning.
TextBlock whole_lines(const InputFile& file, std::string_view head) {
  TextBlock block;
  block.bytes = file.size() == head.size() ? head : head.substr(0, head.find_last_of("\r\n") + 1);
  return block;
}

/// Whether all lines begin with three numbers.
bool are_points(const TextBlock& block, const std::filesystem::path& path, LineSyntax syntax) {
  TextWords words(block, path, syntax);
  NumberTriple numbers;
  while (words.next_line()) {
    for (NumberText& number : numbers)
      if (!read_number(words.word(), syntax.point, number)) return false;
    if (!are_between(syntax.separator, numbers)) return false;
  }
  return true;
}

/// Numbers between blanks, or else commas or semicolons, with decimal points or commas. "1,5 2,5 3,5" are
/// three numbers. What fits none is read as the first, whose message names the line.
LineSyntax xyz_syntax(const TextBlock& block, const std::filesystem::path& path) {
  constexpr std::array dialects{LineSyntax{}, LineSyntax{'#', false, 0, ','},
                                LineSyntax{'#', false, ',', '.'}, LineSyntax{'#', false, ';', '.'},
                                LineSyntax{'#', false, ';', ','}};
  for (const LineSyntax& dialect : dialects)
    if (are_points(block, path, dialect)) return dialect;
  return dialects.front();
}

/// Whether x, y, z are followed by three numbers of length one, and nothing else, in all of the lines:
/// normals then, not colours.
bool has_normals(const TextBlock& block, const std::filesystem::path& path, LineSyntax syntax) {
  TextWords words(block, path, syntax);
  bool found = false;
  while (words.next_line()) {
    NumberTriple triple;
    for (int axis = 0; axis < 3; ++axis) words.word();
    for (NumberText& number : triple)
      if (!read_number(words.word(), syntax.point, number)) return false;
    if (!words.word().empty() || !is_unit(triple)) return false;
    found = true;
  }
  return found;
}

struct CsvHeader {
  char separator = ',';
  char point = '.';  ///< in numbers
  std::array<std::size_t, 3> position{};
  std::optional<std::array<std::size_t, 3>> normal;
  std::size_t columns = 0;
  std::uint64_t size = 0;  ///< bytes
  std::size_t lines = 0;
};

std::optional<std::array<std::size_t, 3>> columns(const std::vector<std::string>& names,
                                                  const std::array<const char*, 3>& wanted) {
  std::array<std::size_t, 3> found{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = std::find_if(names.begin(), names.end(),
                                 [&](const std::string& name) { return lower_case(name) == wanted[axis]; });
    if (at == names.end()) return std::nullopt;
    found[axis] = static_cast<std::size_t>(at - names.begin());
  }
  return found;
}

/// A comma where a coordinate of the lines behind the header has one.
char decimal_point(const std::vector<std::string_view>& lines, const CsvHeader& header) {
  if (header.separator == ',') return '.';
  for (std::size_t i = header.lines; i < lines.size(); ++i) {
    const CsvRow row = csv_row(lines[i], header.separator);
    for (const std::size_t column : header.position)
      if (column < row.cells.size() && has_decimal_comma(csv_characters(row.cells[column]))) return ',';
  }
  return '.';
}

CsvHeader read_header(const InputFile& file) {
  const std::string head = text_head(file);
  const std::vector<std::string_view> lines = text_lines(whole_lines(file, head).bytes);
  CsvHeader header;
  const bool is_named = !lines.empty() && csv_named_separator(lines.front()).has_value();
  header.lines = is_named ? 2 : 1;
  const auto separator =
      header.lines > lines.size()
          ? std::nullopt
          : csv_separator(lines[header.lines - 1], [](const std::vector<std::string>& names) {
              return columns(names, position_names).has_value();
            });
  if (!separator)
    throw FormatError(file.path().string() + ":" + std::to_string(header.lines) +
                      ": the header of a point table names columns x, y and z");
  const std::vector<std::string> names = csv_texts(csv_row(lines[header.lines - 1], *separator));
  header.separator = *separator;
  header.position = *columns(names, position_names);
  header.normal = columns(names, normal_names);
  header.columns = names.size();
  const char* const end = head.data() + head.size();
  header.size = static_cast<std::uint64_t>(
      behind_line_break(lines[header.lines - 1].data() + lines[header.lines - 1].size(), end) - head.data());
  header.point = decimal_point(lines, header);
  return header;
}

/// A table whose header names the columns.
class CsvText : public TextFormat {
 public:
  CsvText(const std::filesystem::path& path, const CsvHeader& header) : path_(path), header_(header) {}

  std::uint64_t begin() const override { return header_.size; }
  TextCutter cutter() const override { return {path_, header_.lines + 1, {}}; }

  TextRecords records(const TextBlock& block) const override {
    TextRecords records;
    records.point = header_.point;
    TextWords words(block, path_, {0, false});
    while (words.next_line()) {
      // An empty first field may stand before a tab that is no blank here.
      const char* begin = words.line_begin();
      while (begin != block.bytes.data() && begin[-1] != '\n' && begin[-1] != '\r') --begin;
      const CsvRow row =
          csv_row({begin, static_cast<std::size_t>(words.line_end() - begin)}, header_.separator);
      if (!row.is_closed) words.fail("a quote that does not end in its line");
      if (row.cells.size() != header_.columns)
        words.fail(std::to_string(row.cells.size()) + " fields where the header has " +
                   std::to_string(header_.columns));
      records.points.push_back(triple(words, row, header_.position));
      if (header_.normal) records.normals.push_back(triple(words, row, *header_.normal));
    }
    return records;
  }

  // A table says nowhere how long it is.
  void require_complete(const std::array<std::uint64_t, 3>&) const override {}

 private:
  NumberTriple triple(TextWords& words, const CsvRow& row, const std::array<std::size_t, 3>& of) const {
    NumberTriple numbers;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string_view field = csv_characters(row.cells[of[axis]]);
      if (!read_number(field, header_.point, numbers[axis]))
        words.fail(std::string(position_names[axis]) + ": " + in_quotes(field) + " is not a finite number");
    }
    return numbers;
  }

  const std::filesystem::path& path_;
  const CsvHeader& header_;
};

}  // namespace

CarrySummary carry_xyz(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress) {
  const std::string head = text_head(file);
  const TextBlock lines = whole_lines(file, head);
  const LineSyntax syntax = xyz_syntax(lines, file.path());
  const XyzText text(file.path(), syntax, has_normals(lines, file.path(), syntax));
  return carry_text(file, outputs, text, motion, progress);
}

CarrySummary carry_csv(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress) {
  const CsvHeader header = read_header(file);
  return carry_text(file, outputs, CsvText(file.path(), header), motion, progress);
}

}  // namespace bespoke
