#pragma once

#include <random>

#include "bespoke/lattice/leaf_table.h"
#include "bespoke/lattice/pyramid.h"

namespace bespoke::test {

/// Leaves of level 0 in a cube of six, and below every leaf each of its octants with probability 0.3, so that
/// leaves with and without neighbours, parents and children of all kinds occur. Values in [-1, 1], multiples
/// of 1/128, the voxels of level 0 of size 1/2.
inline Pyramid random_pyramid(int level_count, unsigned seed) {
  constexpr double share = 0.3;
  std::mt19937 engine(seed);
  std::bernoulli_distribution chosen(share);
  std::uniform_int_distribution<int> value(-128, 128);
  Pyramid pyramid;
  pyramid.origin = Vector3(0.25, -1, 2);
  std::vector<LeafCoordinates> leaves;
  for (int i = -3; i < 3; ++i)
    for (int j = -3; j < 3; ++j)
      for (int k = -3; k < 3; ++k)
        if (chosen(engine)) leaves.push_back({i, j, k});
  for (int level = 0; level < level_count; ++level) {
    PyramidLevel added;
    added.voxel_size = std::ldexp(0.5, -level);
    added.leaves = unique_leaves(leaves);
    added.values.resize(leaf_floats * added.leaves.size());
    for (float& v : added.values) v = static_cast<float>(value(engine)) / 128;
    leaves.clear();
    for (const LeafCoordinates& leaf : added.leaves)
      for (int octant = 0; octant < 8; ++octant)
        if (chosen(engine)) leaves.push_back(child_of(leaf, octant));
    pyramid.levels.push_back(std::move(added));
  }
  return pyramid;
}

/// In and around it.
inline Points points_about_random_pyramid(Eigen::Index count, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> coordinate(-16, 16);
  return Points::NullaryExpr(3, count, [&] { return coordinate(engine); });
}

}  // namespace bespoke::test
