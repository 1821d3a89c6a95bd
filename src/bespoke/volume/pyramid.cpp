#include "bespoke/volume/pyramid.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "bespoke/error.h"
#include "bespoke/volume/leaf_table.h"

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

void require_valid_level(const PyramidLevel& level, std::size_t index) {
  if (!(level.voxel_size > 0 && std::isfinite(level.voxel_size)))
    refuse(index, "voxel size " + std::to_string(level.voxel_size) + " is not positive and finite");
  if (level.leaves.empty()) refuse(index, "no leaf; leave the level out");
  if (level.values.size() != 3 * leaf_nodes * level.leaves.size())
    refuse(index, std::to_string(level.values.size()) + " values for " + std::to_string(level.leaves.size()) +
                      " leaves; each has " + std::to_string(3 * leaf_nodes));
  for (std::size_t i = 0; i < level.leaves.size(); ++i) {
    for (const int coordinate : level.leaves[i])
      if (!(coordinate >= -largest_leaf_coordinate && coordinate <= largest_leaf_coordinate))
        refuse(index, name(level.leaves[i]) + " is out of range");
    if (i > 0 && !(level.leaves[i - 1] < level.leaves[i]))
      refuse(index, name(level.leaves[i]) + " is not in lexicographic order, or twice");
  }
  const auto bad =
      std::find_if(level.values.begin(), level.values.end(), [](float v) { return !std::isfinite(v); });
  if (bad != level.values.end())
    refuse(index,
           "a value of " +
               name(level.leaves[static_cast<std::size_t>(bad - level.values.begin()) / 3 / leaf_nodes]) +
               " is not finite");
}

void require_nested(const PyramidLevel& coarse, const PyramidLevel& fine, std::size_t index) {
  if (!(std::abs(2 * fine.voxel_size - coarse.voxel_size) <= voxel_size_slack * coarse.voxel_size))
    refuse(index, "voxel size " + std::to_string(fine.voxel_size) + " is not half of the level above, " +
                      std::to_string(coarse.voxel_size));
  const LeafTable table(coarse.leaves);
  for (const LeafCoordinates& leaf : fine.leaves)
    if (table.find({leaf[0] >> 1, leaf[1] >> 1, leaf[2] >> 1}) == no_leaf)
      refuse(index, name(leaf) + " has no leaf above it");
}

}  // namespace

std::size_t Pyramid::voxel_count() const {
  std::size_t voxels = 0;
  for (const PyramidLevel& level : levels) voxels += level.leaves.size() * leaf_nodes;
  return voxels;
}

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
    require_valid_level(pyramid.levels[level], level);
    if (level > 0) require_nested(pyramid.levels[level - 1], pyramid.levels[level], level);
  }
}

}  // namespace bespoke
