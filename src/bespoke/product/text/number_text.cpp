#include "bespoke/product/text/number_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "bespoke/csv_rows.h"

namespace bespoke {
namespace {

// Powers of ten that doubles hold exactly.
constexpr int exact_powers = 22;
constexpr std::array<double, exact_powers + 1> powers{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                      1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                      1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// An exponent "e-05", clamped; false when it is none.
bool read_exponent(const char* at, const char* end, int& exponent) {
  const bool negative = at != end && *at == '-';
  if (at != end && (*at == '-' || *at == '+')) ++at;
  if (at == end) return false;
  for (; at != end; ++at) {
    if (!is_digit(*at)) return false;
    exponent = std::min(10 * exponent + (*at - '0'), 9999);
  }
  if (negative) exponent = -exponent;
  return true;
}

}  // namespace

// Clinger's fast path: digits and power of ten are both exact doubles, so one division or multiplication
// rounds once. All else goes to the standard library, whose own speed differs between compilers.
bool read_number(const char* begin, const char* end, NumberText& number) {
  const char* at = begin;
  const bool negative = at != end && *at == '-';
  if (at != end && (*at == '-' || *at == '+')) ++at;
  const char* const unsigned_begin = at;
  std::uint64_t digits = 0;
  int significant = 0, decimals = 0, seen = 0, exponent = 0;
  for (; at != end && is_digit(*at); ++at, ++seen) {
    if (significant < 19) digits = 10 * digits + static_cast<unsigned>(*at - '0');
    significant += significant > 0 || *at != '0';
  }
  if (at != end && *at == '.')
    for (++at; at != end && is_digit(*at); ++at, ++seen, ++decimals) {
      if (significant < 19) digits = 10 * digits + static_cast<unsigned>(*at - '0');
      significant += significant > 0 || *at != '0';
    }
  if (seen == 0 || end - begin > std::numeric_limits<std::int16_t>::max()) return false;
  if (at != end) {
    if ((*at != 'e' && *at != 'E') || !read_exponent(at + 1, end, exponent)) return false;
  }
  const int scale = decimals - exponent;
  if (significant <= 19 && digits <= static_cast<std::uint64_t>(largest_whole) &&
      std::abs(scale) <= exact_powers) {
    const double power = powers[static_cast<std::size_t>(std::abs(scale))];
    number.value = scale > 0 ? static_cast<double>(digits) / power : static_cast<double>(digits) * power;
  } else {
    const auto [last, error] = std::from_chars(unsigned_begin, end, number.value);
    if (error == std::errc::result_out_of_range && significant + exponent < 300)
      number.value = 0;  // underflow
    else if (error != std::errc() || last != end || !std::isfinite(number.value))
      return false;
  }
  if (negative) number.value = -number.value;
  number.begin = begin;
  number.length = static_cast<std::uint32_t>(end - begin);
  number.decimals = static_cast<std::int16_t>(scale);
  number.leading = static_cast<std::int16_t>(significant - scale);
  return true;
}

bool read_number(std::string_view text, char point, NumberText& number) {
  if (point == '.' || text.find_first_of(".,") == std::string_view::npos)
    return read_number(text.data(), text.data() + text.size(), number);
  if (!has_decimal_comma(text)) return false;
  std::string with_point(text);
  std::replace(with_point.begin(), with_point.end(), point, '.');
  const bool is_number = read_number(with_point.data(), with_point.data() + with_point.size(), number);
  number.begin = text.data();
  return is_number;
}

bool read_integer(const char* begin, const char* end, long long& value) {
  if (end - begin > 1 && *begin == '+' && begin[1] != '-') ++begin;
  const auto [last, error] = std::from_chars(begin, end, value);
  return begin != end && error == std::errc() && last == end;
}

void CarriedDecimals::add(const NumberText& number) {
  if (number.value == 0) return;
  const auto order = static_cast<std::size_t>(std::clamp(number.leading + zero, 0, orders - 1));
  most_[order] = seen_[order] ? std::max(most_[order], number.decimals) : number.decimals;
  seen_[order] = true;
}

void CarriedDecimals::merge(const CarriedDecimals& other) {
  for (std::size_t i = 0; i < orders; ++i) {
    if (!other.seen_[i]) continue;
    most_[i] = seen_[i] ? std::max(most_[i], other.most_[i]) : other.most_[i];
    seen_[i] = true;
  }
}

int CarriedDecimals::decimals() const {
  for (std::size_t i = orders; i-- > 0;) {
    if (!seen_[i]) continue;
    const int below = i > 0 && seen_[i - 1] ? most_[i - 1] : 0;
    return std::max({int{most_[i]}, below, 0});
  }
  return 0;
}

int decimals_for(double resolution) {
  return std::clamp(static_cast<int>(std::ceil(-std::log10(resolution))), 0, 300);
}

void append_number(std::string& text, double value, int decimals) {
  std::array<char, 64> buffer;
  const double scaled =
      decimals <= exact_powers ? std::abs(value) * powers[static_cast<std::size_t>(decimals)] : largest_whole;
  if (!(scaled < largest_whole)) {
    const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    text.append(buffer.data(), end);
    return;
  }
  auto digits = static_cast<std::uint64_t>(std::nearbyint(scaled));
  char* at = buffer.data() + buffer.size();
  const bool negative = value < 0 && digits > 0;
  for (int i = 0; i < decimals; ++i, digits /= 10) *--at = static_cast<char>('0' + digits % 10);
  if (decimals > 0) *--at = '.';
  do {
    *--at = static_cast<char>('0' + digits % 10);
    digits /= 10;
  } while (digits > 0);
  if (negative) *--at = '-';
  text.append(at, buffer.data() + buffer.size());
}

bool stays(double read, double value, int decimals) {
  if (read == value) return true;
  return decimals <= exact_powers &&
         std::abs(read - value) < 0.5 / powers[static_cast<std::size_t>(decimals)] &&
         std::abs(value) * powers[static_cast<std::size_t>(decimals)] < largest_whole;
}

}  // namespace bespoke
