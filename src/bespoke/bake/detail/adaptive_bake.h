#pragma once

#include "bespoke/bake/bake.h"

namespace bespoke {

/// The nested pyramid that bake() promises. Throws MemoryLimitError, see PyramidBuilder.
Bake bake_adaptively(const ElasticMap& map, const BakeOptions& options, const Progress& progress);

}  // namespace bespoke
