#include "bespoke/lattice/pyramid_part.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "bespoke/error.h"
#include "bespoke/lattice/detail/pyramid_checks.h"

namespace bespoke {
namespace {

// Beyond all leaves that a valid pyramid has, and far inside an int.
constexpr double largest_cell = 1 << 30;

// Look-ups divide by the voxel size in other ways than leaves_near, so their cell may be the next.
constexpr int spare_cells = 1;

}  // namespace

std::size_t PyramidPart::leaf_count() const {
  std::size_t count = 0;
  for (const std::vector<LeafCoordinates>& level : leaves) count += level.size();
  return count;
}

void require_valid(const PyramidPart& part) {
  const std::vector<PyramidLevel>& read = part.read.levels;
  if (!part.read.origin.allFinite()) throw InvalidInput("pyramid: its origin is not finite");
  if (read.size() != part.leaves.size())
    throw InvalidInput("pyramid: values of " + std::to_string(read.size()) + " levels, leaves of " +
                       std::to_string(part.leaves.size()));
  for (std::size_t index = 0; index < read.size(); ++index) {
    const std::vector<LeafCoordinates>& all = part.leaves[index];
    require_valid_leaves(read[index].voxel_size, all, index);
    require_valid_values(read[index], part.read.precision, index);
    if (!std::includes(all.begin(), all.end(), read[index].leaves.begin(), read[index].leaves.end()))
      throw InvalidInput("pyramid level " + std::to_string(index) +
                         ": values of leaves that it does not have");
    if (index > 0)
      require_nested(read[index - 1].voxel_size, part.leaves[index - 1], read[index].voxel_size, all, index);
  }
}

LeafBox leaves_near(const Lattice& lattice, const Box& box) {
  LeafBox leaves;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell_of = [&](double x) {
      const double place = (x - lattice.origin[axis]) / lattice.voxel_size;
      return static_cast<int>(std::floor(std::clamp(place, -largest_cell, largest_cell)));
    };
    leaves.low[axis] = (cell_of(box.min()[axis]) - spare_cells) >> 3;
    leaves.high[axis] = ((cell_of(box.max()[axis]) + spare_cells) >> 3) + 1;
  }
  return leaves;
}

Box image_box(const Box& box, const AffineMap& affine, const PyramidPart& part) {
  const Vector3 center = affine * Vector3(box.center());
  const Vector3 half = affine.linear.cwiseAbs() * (box.sizes() / 2);
  // Between nodes and at the level boundary, where a level goes to zero, a value is a mean of nodes' values
  // and zeros.
  Vector3 low = Vector3::Zero(), high = Vector3::Zero();
  for (const PyramidLevel& level : part.read.levels) {
    Vector3 least = Vector3::Zero(), largest = Vector3::Zero();
    for (std::size_t i = 0; i < level.values.size(); i += 3) {
      const Vector3 value(level.values[i], level.values[i + 1], level.values[i + 2]);
      least = least.cwiseMin(value);
      largest = largest.cwiseMax(value);
    }
    low += least;
    high += largest;
  }
  return {center - half + low, center + half + high};
}

}  // namespace bespoke
