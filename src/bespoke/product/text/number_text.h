#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace bespoke {

/// Up to here every whole number is a double.
inline constexpr double largest_whole = 0x1p53;

/// A number as a text file writes it.
struct NumberText {
  const char* begin = nullptr;
  std::uint32_t length = 0;
  std::int16_t decimals = 0;  ///< digits after the point, less the exponent
  std::int16_t leading = 0;   ///< decimal exponent of the first digit, plus 1; meaningless for 0
  double value = 0;
};

/// Reads all of [begin, end) as a finite decimal number, correctly rounded; false when it is none. The common
/// short forms cost a few nanoseconds.
bool read_number(const char* begin, const char* end, NumberText& number);

/// The same with a decimal comma, if `point` is one, and digits on both sides of it.
bool read_number(std::string_view text, char point, NumberText& number);

/// Reads all of [begin, end) as a whole number; false when it is none.
bool read_integer(const char* begin, const char* end, long long& value);

/// How many decimals a file's numbers carry. The decimals of a number say little where trailing zeros are
/// left out or exponents are used; those of the numbers of the largest magnitudes decide.
class CarriedDecimals {
 public:
  void add(const NumberText& number);
  void merge(const CarriedDecimals& other);

  /// The most decimals among the numbers of the two largest orders of magnitude, 0 without any.
  int decimals() const;

 private:
  static constexpr int orders = 40, zero = 20;  // 1e-20 … 1e19, beyond that the outermost
  std::array<std::int16_t, orders> most_{};
  std::array<bool, orders> seen_{};
};

/// Decimals that keep values within half of `resolution` (> 0, the numbers' unit).
int decimals_for(double resolution);

/// Appends the value with this many decimals, rounded to nearest; where a double holds fewer digits, the
/// shortest text that is read back as the same double.
void append_number(std::string& text, double value, int decimals);

/// Whether `value`, written with this many decimals, would be the number that was read.
bool stays(double read, double value, int decimals);

}  // namespace bespoke
