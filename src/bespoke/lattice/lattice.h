#pragma once

#include <cmath>

#include "bespoke/lattice/leaf.h"
#include "bespoke/types.h"

namespace bespoke {

/// For arithmetic between nodes.
inline Vector3 as_vector(const LatticeCoordinates& coordinates) {
  return Eigen::Vector3i(coordinates[0], coordinates[1], coordinates[2]).cast<double>();
}

/// Node (i, j, k) lies at origin + voxel_size·(i, j, k), mesh units.
struct Lattice {
  Vector3 origin = Vector3::Zero();
  double voxel_size = 0;

  Vector3 operator()(const LatticeCoordinates& node) const { return at(as_vector(node)); }

  /// The same between nodes.
  Vector3 at(const Vector3& coordinates) const { return origin + voxel_size * coordinates; }

  /// The cell that holds x (mesh units).
  LatticeCoordinates cell_of(const Vector3& x) const {
    const Eigen::Vector3i cell = ((x - origin) / voxel_size).array().floor().cast<int>();
    return {cell.x(), cell.y(), cell.z()};
  }
};

}  // namespace bespoke
