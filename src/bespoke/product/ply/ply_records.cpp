#include "bespoke/product/ply/ply_records.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "bespoke/number_format.h"
#include "bespoke/product/ply/ply_binary.h"
#include "bespoke/product/ply/ply_scalar.h"
#include "bespoke/product/ply/ply_text.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

PlyValues read_line(const PlyElement& element, std::string_view line) {
  TextBlock block;
  block.bytes = line;
  const std::filesystem::path checked;
  TextWords words(block, checked, ply_body_syntax);
  words.next_line();
  PlyValues values;
  for (const PlyProperty& property : element.properties) {
    const long long count = property.count ? words.integer("length of a list") : 1;
    values.emplace_back(static_cast<std::size_t>(count));
    for (SplitNumber& number : values.back()) number = split_number(words.word());
  }
  return values;
}

PlyValues read_bytes(const PlyHeader& header, const PlyElement& element, std::string_view record) {
  PlyValues values;
  std::size_t at = 0;
  for (const PlyProperty& property : element.properties) {
    const std::uint64_t count = skip_property(property, record.data(), is_big(header), at);
    values.emplace_back(static_cast<std::size_t>(count));
    const char* from = record.data() + at - count * size(property.type);
    with_type(property.type, [&](auto zero) {
      for (SplitNumber& number : values.back()) {
        number.value = static_cast<double>(load_scalar<decltype(zero)>(from, is_big(header)));
        from += sizeof zero;
      }
    });
  }
  return values;
}

bool holds(PlyScalar type, double value) {
  return with_type(type, [&](auto zero) {
    using Limits = std::numeric_limits<decltype(zero)>;
    // What is no number is none in floats, and stays.
    if (Limits::has_quiet_NaN && !std::isfinite(value)) return true;
    return value >= static_cast<double>(Limits::lowest()) && value <= static_cast<double>(Limits::max());
  });
}

void append_bytes(std::string& to, const PlyHeader& header, PlyScalar type, double value) {
  const std::size_t at = to.size();
  to.resize(at + size(type));
  with_type(type, [&](auto zero) { store_scalar<decltype(zero)>(to.data() + at, value, is_big(header)); });
}

}  // namespace

PlyRecords::PlyRecords(const InputFile& file, std::string_view text, const PlyHeader& header)
    : name_(file.path().string()),
      text_(text),
      header_(header),
      starts_(header.elements.size()),
      end_(header.size) {
  if (is_text())
    find_lines(file);
  else
    find_records(file);
}

void PlyRecords::find_lines(const InputFile& file) {
  TextBlock block;
  block.bytes = text_.substr(header_.size);
  block.line = header_.lines + 1;
  const PlyText body(file.path(), header_);
  position_decimals_ = bespoke::position_decimals(body.records(block).points);
  std::array<std::uint64_t, 3> sums{};
  line_counter(ply_body_syntax)(block.bytes, sums);
  body.require_complete(sums);
  line_break_ = first_line_break(text_);
  TextWords words(block, file.path(), ply_body_syntax);
  for (std::size_t i = 0; i < starts_.size(); ++i) {
    starts_[i].push_back(end_);
    const PlyElement& element = header_.elements[i];
    for (std::uint64_t k = 0; k < element.count; ++k) {
      // A record without properties has no line.
      if (!element.properties.empty() && words.next_line())
        end_ = static_cast<std::size_t>(words.line_end() - text_.data());
      starts_[i].push_back(end_);
    }
  }
}

void PlyRecords::find_records(const InputFile& file) {
  PlyCutter cutter(file, header_);
  for (std::vector<std::size_t>& starts : starts_) starts.push_back(end_);
  for (const PlyBlock& block : cutter({text_.substr(header_.size), header_.size, true})) {
    if (block.element == starts_.size()) break;
    require_vertices(header_, block, file.path());
    std::vector<std::size_t>& starts = starts_[block.element];
    starts.front() = block.first == 0 ? end_ : starts.front();
    std::size_t at = 0;
    for (std::uint64_t i = 0; i < block.count; ++i) {
      for (const PlyProperty& property : header_.elements[block.element].properties)
        skip_property(property, block.bytes.data(), is_big(header_), at);
      starts.push_back(end_ + at);
    }
    end_ += block.bytes.size();
  }
}

PlyValues PlyRecords::values(std::size_t element, std::size_t record) const {
  const std::string_view found = text(element, record, record + 1);
  return is_text() ? read_line(header_.elements[element], found)
                   : read_bytes(header_, header_.elements[element], found);
}

void PlyRecords::append_value(std::string& to, PlyScalar type, const SplitNumber& number) const {
  if (!is_text()) return append_bytes(to, header_, type, number.value);
  append_number(to, number, !is_real(type));
  to += ' ';
}

void PlyRecords::append(std::string& to, std::size_t element, const PlyValues& values) const {
  const std::vector<PlyProperty>& properties = header_.elements[element].properties;
  const auto require = [&](PlyScalar type, double value, const PlyProperty& property) {
    if (!holds(type, value))
      throw InvalidInput(name_ + ": the type of the property " + property.name + " of the element " +
                         header_.elements[element].name + " does not hold " + format_number(value, 17) +
                         ", which splitting edges needs; give it a wider one");
  };
  if (is_text() && !to.empty() && to.back() != '\n' && to.back() != '\r')
    to += line_break_;  // the file's last line has none
  for (std::size_t i = 0; i < properties.size(); ++i) {
    const PlyProperty& property = properties[i];
    if (property.count) {
      const auto length = static_cast<double>(values[i].size());
      require(*property.count, length, property);
      append_value(to, *property.count, {length, 0, {}});
    }
    for (const SplitNumber& number : values[i]) {
      if (number.word.empty()) require(property.type, number.value, property);
      append_value(to, property.type, number);
    }
  }
  if (!is_text()) return;
  if (!to.empty() && to.back() == ' ') to.pop_back();
  to += line_break_;
}

}  // namespace bespoke
