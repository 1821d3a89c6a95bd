#include "bespoke/product/text/split_numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bespoke/product/text/number_text.h"

namespace bespoke {
namespace {

constexpr int min_real_decimals = 6;  // of new numbers that are no position

}  // namespace

SplitNumber split_number(std::string_view word) {
  NumberText number;
  if (!read_number(word.data(), word.data() + word.size(), number))
    return {std::numeric_limits<double>::quiet_NaN(), 0, word};
  return {number.value, number.decimals, word};
}

SplitNumber middle_number(const SplitNumber& a, const SplitNumber& b, bool is_whole) {
  const double mean = 0.5 * (a.value + b.value);
  return {
      is_whole ? std::floor(mean + 0.5) : mean, std::max({a.decimals, b.decimals, min_real_decimals}), {}};
}

void append_number(std::string& to, const SplitNumber& number, bool is_whole) {
  if (!number.word.empty())
    to += number.word;
  else if (!std::isfinite(number.value))
    to += "nan";
  else if (is_whole)
    to += std::to_string(std::llround(number.value));
  else
    append_number(to, number.value, number.decimals);
}

}  // namespace bespoke
