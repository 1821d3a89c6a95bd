#include "bespoke/lattice/pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "bespoke/error.h"
#include "bespoke/lattice/leaf_table.h"

namespace bespoke {
namespace {

// Node coordinates of a leaf, and of the leaf's neighbours one level down, stay far inside an int.
constexpr int largest_leaf_coordinate = 1 << 26;

// Voxel sizes pass through files; half of one size is exact, a printed decimal may not be.
constexpr double voxel_size_slack = 1e-12;

[[noreturn]] void refuse(std::size_t level, const std::string& why) {
  throw InvalidInput("pyramid level " + std::to_string(level) + ": " + why);
}

std::string name(const LeafCoordinates& leaf) {
  return "leaf (" + std::to_string(leaf[0]) + ", " + std::to_string(leaf[1]) + ", " +
         std::to_string(leaf[2]) + ")";
}

void require_valid_level(const PyramidLevel& level, ValuePrecision precision, std::size_t index) {
  if (!(level.voxel_size > 0 && std::isfinite(level.voxel_size)))
    refuse(index, "voxel size " + std::to_string(level.voxel_size) + " is not positive and finite");
  if (level.leaves.empty()) refuse(index, "no leaf; leave the level out");
  if (level.values.size() != leaf_floats * level.leaves.size())
    refuse(index, std::to_string(level.values.size()) + " values for " + std::to_string(level.leaves.size()) +
                      " leaves; each has " + std::to_string(leaf_floats));
  for (std::size_t i = 0; i < level.leaves.size(); ++i) {
    for (const int coordinate : level.leaves[i])
      if (!(coordinate >= -largest_leaf_coordinate && coordinate <= largest_leaf_coordinate))
        refuse(index, name(level.leaves[i]) + " is out of range");
    if (i > 0 && !(level.leaves[i - 1] < level.leaves[i]))
      refuse(index, name(level.leaves[i]) + " is not in lexicographic order, or twice");
  }
  const auto require_all = [&](const auto& good, const char* what) {
    const auto bad = std::find_if_not(level.values.begin(), level.values.end(), good);
    if (bad == level.values.end()) return;
    const auto leaf = static_cast<std::size_t>(bad - level.values.begin()) / leaf_floats;
    refuse(index, "a value of " + name(level.leaves[leaf]) + " is not " + what);
  };
  require_all([](float value) { return std::isfinite(value); }, "finite");
  if (precision == ValuePrecision::half)
    require_all([](float value) { return value == rounded_to_half(value); }, "of half precision");
}

void require_nested(const PyramidLevel& coarse, const PyramidLevel& fine, std::size_t index) {
  if (!(std::abs(2 * fine.voxel_size - coarse.voxel_size) <= voxel_size_slack * coarse.voxel_size))
    refuse(index, "voxel size " + std::to_string(fine.voxel_size) + " is not half of the level above, " +
                      std::to_string(coarse.voxel_size));
  const LeafTable table(coarse.leaves);
  for (const LeafCoordinates& leaf : fine.leaves)
    if (table.find(parent_of(leaf)) == no_leaf) refuse(index, name(leaf) + " has no leaf above it");
}

}  // namespace

const char* name_of(ValuePrecision precision) {
  return precision == ValuePrecision::half ? "half" : "single";
}

float rounded_to_half(float value) {
  constexpr int least_exponent = -14;  // below it halves are evenly spaced
  constexpr int stored_bits = 10;
  constexpr float largest = 65504;
  if (!std::isfinite(value) || value == 0) return value;
  const float spacing = std::ldexp(1.0f, std::max(std::ilogb(value), least_exponent) - stored_bits);
  const float rounded = std::nearbyint(value / spacing) * spacing;
  return std::abs(rounded) <= largest ? rounded
                                      : std::copysign(std::numeric_limits<float>::infinity(), value);
}

void round_values(std::span<float> values, double tolerance, ValuePrecision precision) {
  constexpr double quantum_of_tolerance = 1.0 / 128;
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
  for (std::size_t level = 0; level < pyramid.levels.size(); ++level) {
    require_valid_level(pyramid.levels[level], pyramid.precision, level);
    if (level > 0) require_nested(pyramid.levels[level - 1], pyramid.levels[level], level);
  }
}

}  // namespace bespoke
