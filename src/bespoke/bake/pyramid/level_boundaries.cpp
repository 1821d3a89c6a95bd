#include "bespoke/bake/pyramid/level_boundaries.h"

#include <algorithm>
#include <utility>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Of a leaf's nodes that touch the neighbour at this step.
double largest_squared_residual(const LeafValues& values, const NodeBlock& coarse,
                                const LatticeCoordinates& step) {
  LatticeCoordinates from, to;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    from[axis] = step[axis] > 0 ? leaf_edge - 1 : 0;
    to[axis] = step[axis] < 0 ? 0 : leaf_edge - 1;
  }
  double largest = 0;
  for (int i = from[0]; i <= to[0]; ++i)
    for (int j = from[1]; j <= to[1]; ++j)
      for (int k = from[2]; k <= to[2]; ++k)
        largest = std::max(largest, squared_residual(values, coarse, {i, j, k}));
  return largest;
}

std::vector<LeafCoordinates> neighbours_beside(const SampledLevels& levels, std::size_t level,
                                               std::size_t leaf, double limit) {
  std::vector<LeafCoordinates> neighbours;
  NodeBlock coarse;
  bool known = false;
  for (int side = 0; side < neighbour_steps; ++side) {
    const LeafCoordinates neighbour = moved(levels[level].leaves[leaf], neighbour_step(side));
    if (levels.has(level, neighbour)) continue;
    if (!known) levels.coarse_sum_at(level, levels[level].leaves[leaf], coarse);
    known = true;
    const double residual =
        largest_squared_residual(*levels[level].values[leaf], coarse, neighbour_step(side));
    if (!(residual <= limit * limit)) neighbours.push_back(neighbour);
  }
  return neighbours;
}

}  // namespace

std::vector<LeafCoordinates> rim_neighbours(const SampledLevels& levels, std::size_t level, double tolerance,
                                            double growth) {
  const double limit = std::min(tolerance, rim_gradient * growth * levels[level].lattice.voxel_size);
  std::vector<std::vector<LeafCoordinates>> found(levels[level].leaves.size());
  parallel_for(found.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t leaf = begin; leaf < end; ++leaf)
      found[leaf] = neighbours_beside(levels, level, leaf, limit);
  });
  std::vector<LeafCoordinates> neighbours;
  for (const auto& part : found) neighbours.insert(neighbours.end(), part.begin(), part.end());
  return unique_leaves(std::move(neighbours));
}

}  // namespace bespoke
