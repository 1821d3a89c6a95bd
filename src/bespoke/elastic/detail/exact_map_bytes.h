#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "bespoke/types.h"

namespace bespoke {

/// The bytes of an exact map, little-endian: integers, and doubles by their bits.
class ExactMapWriter {
 public:
  template <class Unsigned>
  void integer(Unsigned value) {
    static_assert(std::is_unsigned_v<Unsigned>);
    for (std::size_t byte = 0; byte < sizeof value; ++byte)
      bytes_ += static_cast<char>(value >> (8 * byte) & 0xFF);
  }
  void number(double value) { integer(std::bit_cast<std::uint64_t>(value)); }
  void count(Eigen::Index value) { integer(static_cast<std::uint64_t>(value)); }

  template <class Matrix>
  void numbers(const Matrix& values) {
    for (Eigen::Index column = 0; column < values.cols(); ++column)
      for (Eigen::Index row = 0; row < values.rows(); ++row) number(values(row, column));
  }
  void points(const Points& values) {
    count(values.cols());
    numbers(values);
  }
  void affine(const AffineMap& map) {
    numbers(map.linear);
    numbers(map.offset);
  }
  void text(std::string_view value) { bytes_ += value; }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Throws FormatError.
[[noreturn]] void reject_exact_map(const std::string& reason);

/// Takes bytes apart again. Every member throws FormatError where they end too early or hold what no exact
/// map does.
class ExactMapReader {
 public:
  explicit ExactMapReader(std::string_view bytes) : bytes_(bytes) {}

  std::string_view text(std::size_t size) {
    if (bytes_.size() < size)
      reject_exact_map("ends " + std::to_string(size - bytes_.size()) + " bytes too early");
    const std::string_view result = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return result;
  }
  template <class Unsigned>
  Unsigned integer() {
    Unsigned value = 0;
    const std::string_view read = text(sizeof value);
    for (std::size_t byte = 0; byte < sizeof value; ++byte)
      value |= static_cast<Unsigned>(static_cast<unsigned char>(read[byte])) << (8 * byte);
    return value;
  }
  double number(const char* what) {
    const auto value = std::bit_cast<double>(integer<std::uint64_t>());
    if (!(std::abs(value) <= largest)) reject_exact_map(std::string(what) + " is not finite, or absurd");
    return value;
  }
  double positive(const char* what) {
    const double value = number(what);
    if (!(value >= 1 / largest)) reject_exact_map(std::string(what) + " is not above 0");
    return value;
  }
  /// How many items of at least `bytes_each` follow; never more than there are bytes for.
  Eigen::Index count(std::size_t bytes_each, const char* what) {
    const auto value = integer<std::uint64_t>();
    if (value > bytes_.size() / bytes_each)
      reject_exact_map(std::to_string(value) + " " + what + " do not fit into the " +
                       std::to_string(bytes_.size()) + " bytes that follow");
    return static_cast<Eigen::Index>(value);
  }
  template <class Matrix>
  void numbers(Matrix& values, const char* what) {
    for (Eigen::Index column = 0; column < values.cols(); ++column)
      for (Eigen::Index row = 0; row < values.rows(); ++row) values(row, column) = number(what);
  }
  Points points(const char* what) {
    Points values(3, count(3 * sizeof(double), what));
    numbers(values, what);
    return values;
  }
  AffineMap affine() {
    AffineMap map;
    numbers(map.linear, "the affine part");
    numbers(map.offset, "the affine part");
    return map;
  }
  void end() const {
    if (!bytes_.empty()) reject_exact_map(std::to_string(bytes_.size()) + " bytes too many");
  }

 private:
  // Far beyond any model in any unit; maps form products of up to six lengths, which must stay finite.
  static constexpr double largest = 1e50;

  std::string_view bytes_;
};

}  // namespace bespoke
