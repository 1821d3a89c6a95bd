#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/bake/pyramid/sampled_levels.h"

namespace bespoke {

/// η: what a level boundary may add to the gradient. Without the rule 30,877 of 1.1 M cells of the
/// prototype's body pair folded, with it 2.
inline constexpr double rim_gradient = 0.3;

/// Where a level ends, the residual r of its outermost nodes drops to zero within one voxel h, which adds a
/// gradient of about |r| / h, beside the affine part's of about `growth`. The leaves of a level > 0 that are
/// missing beside a node where |r| > min(tolerance, η growth h); in lexicographic order. `tolerance` in mesh
/// units.
std::vector<LeafCoordinates> rim_neighbours(const SampledLevels& levels, std::size_t level, double tolerance,
                                            double growth);

}  // namespace bespoke
