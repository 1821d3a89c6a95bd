#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "bespoke/product/ply/ply_header.h"
#include "bespoke/product/text/split_numbers.h"

namespace bespoke {

/// Of every property of a record its values: one, or those of a list.
using PlyValues = std::vector<std::vector<SplitNumber>>;

/// The records of a PLY file, of any encoding, that is in memory.
class PlyRecords {
 public:
  /// The text and the header must outlive it. Throws FormatError naming the line or the record at fault.
  PlyRecords(const InputFile& file, std::string_view text, const PlyHeader& header);

  /// What records of an element, from `first` on and before `last`, are in the file.
  std::string_view text(std::size_t element, std::size_t first, std::size_t last) const {
    const std::vector<std::size_t>& starts = starts_[element];
    return text_.substr(starts[first], starts[last] - starts[first]);
  }
  std::string_view text_behind_all() const { return text_.substr(end_); }

  /// Decimals of new coordinates of a text.
  int position_decimals() const { return position_decimals_; }

  PlyValues values(std::size_t element, std::size_t record) const;

  /// Appends a record. Throws InvalidInput, naming the property, for a value that its type does not hold.
  void append(std::string& to, std::size_t element, const PlyValues& values) const;

 private:
  bool is_text() const { return header_.encoding == PlyHeader::Encoding::ascii; }
  void find_lines(const InputFile& file);
  void find_records(const InputFile& file);
  void append_value(std::string& to, PlyScalar type, const SplitNumber& number) const;

  std::string name_;
  std::string_view text_;
  const PlyHeader& header_;
  std::vector<std::vector<std::size_t>> starts_;  ///< of an element's records, and where they end
  std::size_t end_ = 0;
  std::string_view line_break_ = "\n";
  int position_decimals_ = 0;
};

}  // namespace bespoke
