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

/// 2 to the number of times that one model is twice as large as another, or half (negative): 1 for sizes
/// between 0.55 and 1.83, since a ratio counts as a power of two from a twelfth before it on, and for one
/// that is not finite and above 0. Lengths that go with a model's size are scaled by it, which rounds
/// nothing: a target twice as large has a map twice as large, and on models of about one size lengths stay as
/// they were requested.
double power_of_two_scale(double size_ratio);

/// "0.02" or "10%"; empty unless it is finite and within the range.
std::optional<Length> parse_length(std::string_view text, LengthRange range = LengthRange::positive);

}  // namespace bespoke
