#pragma once

#include <string>

#include "bespoke/types.h"

namespace bespoke {

/// The value in at most `digits` significant decimal digits (1 … 17; 17 are read back as the same double),
/// without zeros at the end, as messages, tables and text files have it.
std::string format_number(double value, int digits);

/// "(x, y, z)" of such numbers.
std::string format_number(const Vector3& vector, int digits);

}  // namespace bespoke
