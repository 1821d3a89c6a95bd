#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// Vectors on all nodes of a box: node (i, j, k) lies at origin + voxel_size · (i, j, k).
struct VectorGrid {
  std::string name;                  ///< as other programs list it
  std::string meaning;               ///< one line, metadata `bespoke:meaning`
  Vector3 origin = Vector3::Zero();  ///< mesh units
  double voxel_size = 0;             ///< mesh units
  std::array<std::size_t, 3> size{};
  const std::vector<float>& values;  ///< three a node, mesh units, i runs fastest
};

/// The bytes of a .vdb file with this one grid: Vec3S, contravariant-relative, background 0, the box's nodes
/// active. No asset: it has no record and no trailer. The same grid gives the same bytes. Throws InvalidInput
/// for a voxel size that OpenVDB cannot hold, values that are not finite, or other than three a node.
std::string vdb_of_one_grid(const VectorGrid& grid);

}  // namespace bespoke
