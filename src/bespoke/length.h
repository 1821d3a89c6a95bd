#pragma once

#include <optional>
#include <string_view>

namespace bespoke {

/// A length as people give it: mesh units, or a percentage of a model's bounding-box diagonal.
struct Length {
  double value = 0;
  bool percent = false;

  double in_mesh_units(double diagonal) const { return percent ? value / 100 * diagonal : value; }
};

enum class LengthRange { positive, not_negative };

/// "0.02" or "10%"; empty unless it is finite and within the range.
std::optional<Length> parse_length(std::string_view text, LengthRange range = LengthRange::positive);

}  // namespace bespoke
