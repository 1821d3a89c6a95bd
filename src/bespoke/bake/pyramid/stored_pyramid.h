#pragma once

#include "bespoke/bake/pyramid/sampled_levels.h"
#include "bespoke/lattice/pyramid.h"

namespace bespoke {

/// The residuals of the levels, rounded (round_values): each level's against the sum of the coarser ones as
/// they are stored, that is, rounded. Leaves that are zero and have none below them are left out. `tolerance`
/// in mesh units.
Pyramid stored_pyramid(SampledLevels levels, double tolerance, ValuePrecision precision);

}  // namespace bespoke
