#pragma once

#include <algorithm>
#include <random>
#include <utility>

#include "bespoke/lattice/pyramid_part.h"

namespace bespoke::test {

/// What points in the box require of a pyramid in memory.
inline PyramidPart part_of(const Pyramid& whole, const Box& box) {
  PyramidPart part;
  part.read.origin = whole.origin;
  part.read.precision = whole.precision;
  for (const PyramidLevel& level : whole.levels) {
    const LeafBox near = leaves_near({whole.origin, level.voxel_size}, box);
    PyramidLevel read{level.voxel_size, {}, {}};
    for (std::size_t i = 0; i < level.leaves.size(); ++i) {
      bool is_near = true;
      for (int axis = 0; axis < 3; ++axis)
        is_near =
            is_near && level.leaves[i][axis] >= near.low[axis] && level.leaves[i][axis] <= near.high[axis];
      if (!is_near) continue;
      read.leaves.push_back(level.leaves[i]);
      read.values.insert(read.values.end(), level.values_of(i), level.values_of(i) + leaf_floats);
    }
    part.read.levels.push_back(std::move(read));
    part.leaves.push_back(level.leaves);
  }
  return part;
}

/// A box of up to `largest` along each axis about the points of points_about_random_pyramid, and points in
/// it, its corners among them.
inline Box random_box(std::mt19937& engine, double largest) {
  std::uniform_real_distribution<double> place(-4, 6), size(0, largest);
  const Vector3 low(place(engine), place(engine), place(engine));
  return {low, low + Vector3(size(engine), size(engine), size(engine))};
}

inline Points points_in(const Box& box, Eigen::Index count, std::mt19937& engine) {
  std::uniform_real_distribution<double> share(0, 1);
  Points x(3, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (int axis = 0; axis < 3; ++axis)
      x(axis, i) = i < 8 ? (i >> axis & 1 ? box.max() : box.min())[axis]
                         : std::min(box.max()[axis], box.min()[axis] + share(engine) * box.sizes()[axis]);
  return x;
}

}  // namespace bespoke::test
