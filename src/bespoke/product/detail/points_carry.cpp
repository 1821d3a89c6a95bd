#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>

#include "bespoke/error.h"
#include "bespoke/product/detail/product_formats.h"
#include "bespoke/product/detail/text_records.h"
#include "bespoke/strings.h"

namespace bespoke {
namespace {

// What a unit vector written with four digits may miss.
constexpr double unit_tolerance = 1e-3;

bool is_unit(const NumberTriple& triple) {
  return std::abs(std::hypot(triple[0].value, triple[1].value, triple[2].value) - 1) <= unit_tolerance;
}

/// A point a line: x, y, z, and whatever follows.
class XyzText : public TextFormat {
 public:
  XyzText(const std::filesystem::path& path, bool with_normals) : path_(path), has_normals_(with_normals) {}

  TextCutter cutter() const override { return {path_, 1, {}}; }

  TextRecords records(const TextBlock& block) const override {
    TextRecords records;
    TextWords words(block, path_);
    while (words.next_line()) {
      records.points.push_back({words.number("x"), words.number("y"), words.number("z")});
      if (!has_normals_) continue;
      records.normals.push_back({words.number("nx"), words.number("ny"), words.number("nz")});
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
  bool has_normals_;
  mutable std::atomic<bool> not_all_units_ = false;
};

/// Whether x, y, z are followed by three numbers of length one, and nothing else, in all lines of the file's
/// beginning: normals then, not colours.
bool has_normals(const InputFile& file) {
  const std::string head = file_head(file);
  TextBlock block;
  block.bytes = std::string_view(head).substr(0, head.rfind('\n') + 1);
  if (file.size() == head.size()) block.bytes = head;
  TextWords words(block, file.path());
  bool found = false;
  while (words.next_line()) {
    NumberTriple triple;
    for (int axis = 0; axis < 3; ++axis) words.word();
    for (NumberText& number : triple) {
      const std::string_view word = words.word();
      if (word.empty() || !read_number(word.data(), word.data() + word.size(), number)) return false;
    }
    if (!words.word().empty() || !is_unit(triple)) return false;
    found = true;
  }
  return found;
}

/// The fields of a line, without blanks and quotes around them.
std::vector<std::string_view> fields(std::string_view line, char separator, bool& is_closed) {
  std::vector<std::string_view> result;
  is_closed = true;
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  std::size_t begin = 0;
  bool in_quotes = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') in_quotes = !in_quotes;
    if (i < line.size() && (line[i] != separator || in_quotes)) continue;
    std::string_view field = line.substr(begin, i - begin);
    while (!field.empty() && (field.front() == ' ' || field.front() == '\t')) field.remove_prefix(1);
    while (!field.empty() && (field.back() == ' ' || field.back() == '\t')) field.remove_suffix(1);
    if (field.size() > 1 && field.front() == '"' && field.back() == '"')
      field = field.substr(1, field.size() - 2);
    result.push_back(field);
    begin = i + 1;
  }
  is_closed = !in_quotes;
  return result;
}

struct CsvHeader {
  char separator = ',';
  std::array<std::size_t, 3> position{};
  std::optional<std::array<std::size_t, 3>> normal;
  std::size_t columns = 0;
  std::uint64_t size = 0;  ///< bytes
};

std::optional<std::array<std::size_t, 3>> columns(const std::vector<std::string_view>& names,
                                                  const std::array<const char*, 3>& wanted) {
  std::array<std::size_t, 3> found{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = std::find_if(names.begin(), names.end(),
                                 [&](std::string_view name) { return lower_case(name) == wanted[axis]; });
    if (at == names.end()) return std::nullopt;
    found[axis] = static_cast<std::size_t>(at - names.begin());
  }
  return found;
}

CsvHeader read_header(const InputFile& file) {
  const std::string head = file_head(file);
  CsvHeader header;
  const std::size_t line_end = std::min(head.find('\n'), head.size() - 1) + 1;
  std::string_view line(head.data(), line_end);
  if (line.substr(0, 3) == "\xef\xbb\xbf") line.remove_prefix(3);
  for (const char separator : {',', ';', '\t'}) {
    bool is_closed = true;
    const std::vector<std::string_view> names = fields(line, separator, is_closed);
    const auto position = columns(names, {"x", "y", "z"});
    if (!position) continue;
    header.separator = separator;
    header.position = *position;
    header.normal = columns(names, {"nx", "ny", "nz"});
    header.columns = names.size();
    header.size = line_end;
    return header;
  }
  throw FormatError(file.path().string() + ":1: the header of a point table names columns x, y and z");
}

/// A table whose header names the columns.
class CsvText : public TextFormat {
 public:
  CsvText(const std::filesystem::path& path, const CsvHeader& header) : path_(path), header_(header) {}

  std::uint64_t begin() const override { return header_.size; }
  TextCutter cutter() const override { return {path_, 2, {}}; }

  TextRecords records(const TextBlock& block) const override {
    TextRecords records;
    TextWords words(block, path_, {0, false});
    while (words.next_line()) {
      // An empty first field may stand before a tab that is no blank here.
      const char* begin = words.line_begin();
      while (begin != block.bytes.data() && begin[-1] != '\n') --begin;
      bool is_closed = true;
      const std::vector<std::string_view> row =
          fields({begin, static_cast<std::size_t>(words.line_end() - begin)}, header_.separator, is_closed);
      if (!is_closed) words.fail("a quote that does not end in its line");
      if (row.size() != header_.columns)
        words.fail(std::to_string(row.size()) + " fields where the header has " +
                   std::to_string(header_.columns));
      records.points.push_back(triple(words, row, header_.position));
      if (header_.normal) records.normals.push_back(triple(words, row, *header_.normal));
    }
    return records;
  }

  // A table says nowhere how long it is.
  void require_complete(const std::array<std::uint64_t, 3>&) const override {}

 private:
  static NumberTriple triple(TextWords& words, const std::vector<std::string_view>& row,
                             const std::array<std::size_t, 3>& of) {
    NumberTriple numbers;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string_view field = row[of[axis]];
      if (!read_number(field.data(), field.data() + field.size(), numbers[axis]))
        words.fail(std::string(1, "xyz"[axis]) + ": " + in_quotes(field) + " is not a finite number");
    }
    return numbers;
  }

  const std::filesystem::path& path_;
  const CsvHeader& header_;
};

}  // namespace

CarrySummary carry_xyz(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress) {
  return carry_text(file, outputs, XyzText(file.path(), has_normals(file)), motion, progress);
}

CarrySummary carry_csv(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress) {
  const CsvHeader header = read_header(file);
  return carry_text(file, outputs, CsvText(file.path(), header), motion, progress);
}

}  // namespace bespoke
