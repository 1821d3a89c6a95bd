#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/lattice/pyramid.h"

namespace bespoke {

/// What makes a pyramid valid, level by level. All throw InvalidInput, naming the level `index`.

/// A voxel size above zero, and leaves in lexicographic order, each once and within range.
void require_valid_leaves(double voxel_size, const std::vector<LeafCoordinates>& leaves, std::size_t index);

/// leaf_floats values a leaf, finite and of the precision.
void require_valid_values(const PyramidLevel& level, ValuePrecision precision, std::size_t index);

/// Half the voxel size of the level above, and every leaf inside one of its leaves.
void require_nested(double coarse_voxel_size, const std::vector<LeafCoordinates>& coarse,
                    double fine_voxel_size, const std::vector<LeafCoordinates>& fine, std::size_t index);

}  // namespace bespoke
