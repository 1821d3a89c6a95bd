#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "bespoke/error.h"
#include "bespoke/number_format.h"

namespace bespoke {

/// Numbers in files of points.

/// So many digits that the same double is read back.
inline std::string all_digits(double value) { return format_number(value, 17); }

/// All of the text as a finite decimal number, in any locale; empty otherwise.
inline std::optional<double> decimal_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// The same; throws FormatError "where: …" where it is empty.
inline double finite_number(const std::string& text, const std::string& where) {
  const std::optional<double> value = decimal_number(text);
  if (!value) throw FormatError(where + ": \"" + text.substr(0, 40) + "\" is not a finite number");
  return *value;
}

}  // namespace bespoke
