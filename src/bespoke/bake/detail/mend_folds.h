#pragma once

#include <memory>

#include "bespoke/bake/bake.h"
#include "bespoke/bake/detail/pyramid_builder.h"

namespace bespoke {

/// Certifies the pyramid of `bake`, which `builder` made, and mends what folds: first by finer leaves where
/// the map itself keeps its orientation, then by moving nodes (repair_folds), all of them or none. Fills what
/// the summary says about folds and about the builder, whose memory is given back before nodes are moved.
void mend_folds(const ElasticMap& map, std::unique_ptr<PyramidBuilder> builder, Bake& bake,
                const Progress& progress);

}  // namespace bespoke
