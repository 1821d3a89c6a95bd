#pragma once

#include <cmath>
#include <string>

#include "bespoke/error.h"
#include "bespoke/number_format.h"

namespace bespoke {

/// Numbers in the point files of other programs.

/// So many digits that the same double is read back.
inline std::string all_digits(double value) { return format_number(value, 17); }

/// All of the text as a finite number; throws FormatError "where: …" otherwise.
inline double finite_number(const std::string& text, const std::string& where) {
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != text.size() || !std::isfinite(value))
    throw FormatError(where + ": \"" + text.substr(0, 40) + "\" is not a finite number");
  return value;
}

}  // namespace bespoke
