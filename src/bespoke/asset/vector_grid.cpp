#include "bespoke/asset/vector_grid.h"

#include <algorithm>

#include "bespoke/asset/grids/grid_conversion.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr std::size_t leaf_grain = 64;

/// Leaves that hold all nodes of the box, in lexicographic order.
std::vector<LeafCoordinates> leaves_of(const std::array<std::size_t, 3>& size) {
  std::array<int, 3> count;
  for (std::size_t axis = 0; axis < 3; ++axis)
    count[axis] = static_cast<int>((size[axis] + leaf_edge - 1) / leaf_edge);
  std::vector<LeafCoordinates> leaves;
  for (int i = 0; i < count[0]; ++i)
    for (int j = 0; j < count[1]; ++j)
      for (int k = 0; k < count[2]; ++k) leaves.push_back({i, j, k});
  return leaves;
}

/// Copies what a leaf holds of the box; the rest of it stays 0 and inactive.
void fill_leaf(const VectorGrid& grid, const LeafCoordinates& leaf, float* values, LeafMask& active) {
  const LatticeCoordinates first = first_node(leaf);
  for (int number = 0; number < leaf_nodes; ++number) {
    const LatticeCoordinates node = moved(first, place_of_number(number));
    std::array<std::size_t, 3> at;
    for (std::size_t axis = 0; axis < 3; ++axis) at[axis] = static_cast<std::size_t>(node[axis]);
    if (at[0] >= grid.size[0] || at[1] >= grid.size[1] || at[2] >= grid.size[2]) continue;
    const std::size_t index = (at[2] * grid.size[1] + at[1]) * grid.size[0] + at[0];
    std::copy_n(&grid.values[3 * index], 3, values + 3 * number);
    active[static_cast<std::size_t>(number) / 64] |= std::uint64_t{1} << (number % 64);
  }
}

}  // namespace

std::string vdb_of_one_grid(const VectorGrid& grid) {
  if (grid.values.size() != 3 * grid.size[0] * grid.size[1] * grid.size[2])
    throw InvalidInput("grid " + grid.name + ": " + std::to_string(grid.values.size()) +
                       " values for three on each of " + std::to_string(grid.size[0]) + " x " +
                       std::to_string(grid.size[1]) + " x " + std::to_string(grid.size[2]) + " nodes");
  StoredGrid stored;
  stored.name = grid.name;
  stored.voxel_size = grid.voxel_size;
  stored.origin = grid.origin;
  stored.metadata["bespoke:meaning"] = grid.meaning;
  stored.leaves = leaves_of(grid.size);
  stored.active.resize(stored.leaves.size());
  stored.values.resize(stored.leaves.size() * leaf_floats);
  parallel_for(stored.leaves.size(), leaf_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      fill_leaf(grid, stored.leaves[i], &stored.values[i * leaf_floats], stored.active[i]);
  });
  require_valid(stored);
  return vdb_bytes({{}, {std::move(stored)}});
}

}  // namespace bespoke
