#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "bespoke/lattice/pyramid.h"

namespace bespoke {

/// The metadata types that an asset uses; all of them standard OpenVDB types.
using MetadataValue = std::variant<bool, std::int64_t, double, std::string, Vector3>;
using Metadata = std::map<std::string, MetadataValue>;

/// One bit a node, in the order of the leaf's values.
using LeafMask = std::array<std::uint64_t, leaf_nodes / 64>;

enum class GridClass { unknown, level_set };

/// A grid of an asset as plain data. Node (i, j, k) lies at origin + voxel_size·(i, j, k).
struct StoredGrid {
  std::string name;
  int components = 3;  ///< 3: Vec3S, contravariant-relative; 1: Float
  GridClass grid_class = GridClass::unknown;
  bool half = false;                    ///< stored as 16-bit floats, which must hold every value exactly
  double voxel_size = 0;                ///< mesh units
  Vector3 origin = Vector3::Zero();     ///< mesh units
  float background = 0;                 ///< of every component
  std::vector<LeafCoordinates> leaves;  ///< in lexicographic order, each once
  std::vector<LeafMask> active;         ///< one a leaf; empty = every node of every leaf
  std::vector<float> values;            ///< components·512 a leaf, laid out as in PyramidLevel
  Metadata metadata;                    ///< of this grid, keys start with "bespoke:"
};

/// OpenVDB takes a smaller one (its cube below 3e-15) for a degenerate transform. Mesh units.
inline constexpr double min_voxel_size = 1.5e-5;

/// Throws InvalidInput, naming `what`, for a voxel size that OpenVDB cannot hold.
void require_storable(double voxel_size, const std::string& what);

/// What the OpenVDB part of an asset holds.
struct StoredFile {
  Metadata metadata;
  std::vector<StoredGrid> grids;
};

/// The grids' common promises: known number of components, storable voxel size, finite origin and
/// values, at least one leaf, sizes that fit each other, leaves in order. Throws InvalidInput naming the
/// grid.
void require_valid(const StoredGrid& grid);

/// A flat form for a pipe between two processes of one machine.
std::string to_bytes(const StoredFile& file);

/// Throws InvalidInput where the bytes are not what to_bytes writes; never reads or allocates beyond them.
StoredFile stored_file_from_bytes(std::string_view bytes);

}  // namespace bespoke
