#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/bake/detail/sampled_levels.h"

namespace bespoke {

/// Where a level ends, the residual r of its outermost nodes drops to zero within one voxel h, which adds a
/// gradient of about |r| / h. The leaves of a level > 0 that are missing beside a node where
/// |r| > min(tolerance, η h), η = 0.3; in lexicographic order. `tolerance` in mesh units.
std::vector<LeafCoordinates> rim_neighbours(const SampledLevels& levels, std::size_t level, double tolerance);

}  // namespace bespoke
