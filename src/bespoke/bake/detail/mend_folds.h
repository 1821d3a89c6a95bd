#pragma once

#include <memory>
#include <vector>

#include "bespoke/bake/bake.h"
#include "bespoke/bake/detail/pyramid_builder.h"
#include "bespoke/certificate/certificate.h"

namespace bespoke {

/// Certifies the pyramid of `bake`, which `builder` made, and gives cells that fold although the map itself
/// keeps its orientation finer leaves, for as long as that leaves fewer of them: where the map is nearly flat
/// it does not, because finer leaves bring rims of their own. Returns what still folds.
std::vector<FoldedCell> refine_folds(const ElasticMap& map, std::unique_ptr<PyramidBuilder>& builder,
                                     Bake& bake, const Progress& progress);

/// Mends `folds`, all that the pyramid has, by moving nodes (repair_folds): all of them or none, since half a
/// repair would cost accuracy and prove nothing. Fills what the summary says about it.
void repair_all_or_none(const ElasticMap& map, const std::vector<FoldedCell>& folds, Bake& bake,
                        const Progress& progress);

}  // namespace bespoke
