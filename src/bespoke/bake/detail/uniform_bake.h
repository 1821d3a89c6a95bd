#pragma once

#include "bespoke/bake/bake.h"

namespace bespoke {

/// u on one level of this voxel size (mesh units). Throws MemoryLimitError before anything is sampled, naming
/// the voxel size and the tolerance that would fit, when the level needs more than options.max_memory.
Bake bake_uniformly(const ElasticMap& map, double voxel_size, const BakeOptions& options,
                    const Progress& progress);

}  // namespace bespoke
