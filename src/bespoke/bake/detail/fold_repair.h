#pragma once

#include <memory>

#include "bespoke/bake/bake.h"
#include "bespoke/bake/detail/pyramid_builder.h"

namespace bespoke {

/// Certifies the pyramid of `bake`, which `builder` made, and gives cells that fold although the map itself
/// keeps its orientation finer leaves, for as long as that leaves fewer of them: where the map is nearly flat
/// it does not, because finer leaves bring level boundaries of their own. The certificate lists all that
/// still folds.
void refine_folds(const ElasticMap& map, std::unique_ptr<PyramidBuilder>& builder, Bake& bake,
                  const Progress& progress);

/// Repairs all that the certificate lists by moving nodes (repair_folds), or none, since half a repair would
/// cost accuracy and prove nothing. Fills what the summary says about it.
void repair_all_or_none(const ElasticMap& map, Bake& bake, const Progress& progress);

}  // namespace bespoke
