#include "bespoke/lattice/pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "bespoke/lattice/detail/pyramid_checks.h"
#include "bespoke/lattice/leaf_table.h"

namespace bespoke {
namespace {

bool is_zero(const float* value) { return value[0] == 0 && value[1] == 0 && value[2] == 0; }

}  // namespace

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

Points moved_nodes(const Pyramid& pyramid) {
  std::vector<Vector3> found;
  LeafTable finer;
  const PyramidLevel* below = nullptr;
  const auto moves_below = [&](const LatticeCoordinates& node) {
    const LatticeCoordinates fine{2 * node[0], 2 * node[1], 2 * node[2]};
    const int leaf = below ? finer.find(leaf_of(fine)) : no_leaf;
    return leaf != no_leaf && !is_zero(below->values_of(static_cast<std::size_t>(leaf)) +
                                       3 * number_of_place(place_in_leaf(fine)));
  };
  for (std::size_t k = pyramid.levels.size(); k-- > 0;) {
    const PyramidLevel& level = pyramid.levels[k];
    for (std::size_t leaf = 0; leaf < level.leaves.size(); ++leaf)
      for (int number = 0; number < leaf_nodes; ++number) {
        const LatticeCoordinates node = moved(first_node(level.leaves[leaf]), place_of_number(number));
        if (is_zero(level.values_of(leaf) + 3 * number) || moves_below(node)) continue;
        found.push_back(pyramid.lattice(static_cast<int>(k))(node));
      }
    finer = LeafTable(level.leaves);
    below = &level;
  }
  Points nodes(3, static_cast<Eigen::Index>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) nodes.col(static_cast<Eigen::Index>(i)) = found[i];
  return nodes;
}

}  // namespace bespoke
