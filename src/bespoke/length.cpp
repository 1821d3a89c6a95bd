#include "bespoke/length.h"

#include <charconv>
#include <cmath>

namespace bespoke {

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
