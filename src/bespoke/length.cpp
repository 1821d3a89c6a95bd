#include "bespoke/length.h"

#include <charconv>
#include <cmath>

namespace bespoke {

double power_of_two_scale(double size_ratio) {
  constexpr double reached = 0.125;  // powers of two: sizes are told by anchors or areas, never to the bit
  const double log2_scale = std::log2(size_ratio);
  return std::isfinite(log2_scale) ? std::exp2(std::trunc(log2_scale + std::copysign(reached, log2_scale)))
                                   : 1;
}

std::optional<Length> parse_length(std::string_view text, LengthRange range) {
  Length length;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, length.value);
  length.percent = stop != end && *stop == '%';
  const bool complete = error == std::errc() && stop + length.percent == end;
  const bool in_range = length.value > 0 || (range == LengthRange::not_negative && length.value == 0);
  if (!complete || !in_range || !std::isfinite(length.value)) return std::nullopt;
  return length;
}

}  // namespace bespoke
