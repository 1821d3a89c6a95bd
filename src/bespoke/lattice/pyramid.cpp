#include "bespoke/lattice/pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "bespoke/lattice/detail/pyramid_checks.h"

namespace bespoke {

const char* name_of(ValuePrecision precision) {
  return precision == ValuePrecision::half ? "half" : "single";
}

float rounded_to_half(float value) {
  constexpr int min_exponent = -14;  // below it halves are evenly spaced
  constexpr int stored_bits = 10;
  constexpr float largest = 65504;
  if (!std::isfinite(value) || value == 0) return value;
  const float spacing = std::ldexp(1.0f, std::max(std::ilogb(value), min_exponent) - stored_bits);
  const float rounded = std::nearbyint(value / spacing) * spacing;
  return std::abs(rounded) <= largest ? rounded
                                      : std::copysign(std::numeric_limits<float>::infinity(), value);
}

void round_values(std::span<float> values, double tolerance, ValuePrecision precision) {
  constexpr double quantum_of_tolerance = 1.0 / 32;
  const auto quantum = static_cast<float>(std::exp2(std::floor(std::log2(quantum_of_tolerance * tolerance))));
  for (float& value : values) {
    // A float beyond this is a multiple already.
    if (std::abs(value) < 0x1p23f * quantum) value = std::nearbyint(value / quantum) * quantum;
    if (precision == ValuePrecision::single) continue;
    value = rounded_to_half(value);
    if (!std::isfinite(value))
      throw InvalidInput(
          "a displacement exceeds 65504, the largest number of half precision; use single precision");
  }
}

std::size_t Pyramid::leaf_count() const {
  std::size_t leaves = 0;
  for (const PyramidLevel& level : levels) leaves += level.leaves.size();
  return leaves;
}

std::size_t Pyramid::voxel_count() const { return leaf_nodes * leaf_count(); }

std::size_t Pyramid::byte_count() const {
  std::size_t bytes = 0;
  for (const PyramidLevel& level : levels)
    bytes += level.values.size() * sizeof(float) + level.leaves.size() * sizeof(LeafCoordinates);
  return bytes;
}

double largest_sum(const Pyramid& pyramid) {
  double sum = 0;
  for (const PyramidLevel& level : pyramid.levels) {
    float largest = 0;
    for (const float value : level.values) largest = std::max(largest, std::abs(value));
    sum += largest;
  }
  return sum;
}

void require_valid(const Pyramid& pyramid) {
  if (!pyramid.origin.allFinite()) throw InvalidInput("pyramid: its origin is not finite");
  for (std::size_t index = 0; index < pyramid.levels.size(); ++index) {
    const PyramidLevel& level = pyramid.levels[index];
    require_valid_leaves(level.voxel_size, level.leaves, index);
    require_valid_values(level, pyramid.precision, index);
    if (index == 0) continue;
    const PyramidLevel& above = pyramid.levels[index - 1];
    require_nested(above.voxel_size, above.leaves, level.voxel_size, level.leaves, index);
  }
}

}  // namespace bespoke
