#include "bespoke/lattice/detail/pyramid_checks.h"

#include <algorithm>
#include <cmath>
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

}  // namespace

void require_valid_leaves(double voxel_size, const std::vector<LeafCoordinates>& leaves, std::size_t index) {
  if (!(voxel_size > 0 && std::isfinite(voxel_size)))
    refuse(index, "voxel size " + std::to_string(voxel_size) + " is not positive and finite");
  if (leaves.empty()) refuse(index, "no leaf; leave the level out");
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    for (const int coordinate : leaves[i])
      if (!(coordinate >= -largest_leaf_coordinate && coordinate <= largest_leaf_coordinate))
        refuse(index, name(leaves[i]) + " is out of range");
    if (i > 0 && !(leaves[i - 1] < leaves[i]))
      refuse(index, name(leaves[i]) + " is not in lexicographic order, or twice");
  }
}

void require_valid_values(const PyramidLevel& level, ValuePrecision precision, std::size_t index) {
  if (level.values.size() != leaf_floats * level.leaves.size())
    refuse(index, std::to_string(level.values.size()) + " values for " + std::to_string(level.leaves.size()) +
                      " leaves; each has " + std::to_string(leaf_floats));
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

void require_nested(double coarse_voxel_size, const std::vector<LeafCoordinates>& coarse,
                    double fine_voxel_size, const std::vector<LeafCoordinates>& fine, std::size_t index) {
  if (!(std::abs(2 * fine_voxel_size - coarse_voxel_size) <= voxel_size_slack * coarse_voxel_size))
    refuse(index, "voxel size " + std::to_string(fine_voxel_size) + " is not half of the level above, " +
                      std::to_string(coarse_voxel_size));
  const LeafTable table(coarse);
  for (const LeafCoordinates& leaf : fine)
    if (table.find(parent_of(leaf)) == no_leaf) refuse(index, name(leaf) + " has no leaf above it");
}

}  // namespace bespoke
