#pragma once

#include "bespoke/lattice/pyramid_index.h"

namespace bespoke {

/// Sum of the levels at the columns of x (3×n, mesh units), 3×n; NaN where x is not finite.
Points look_up(const Pyramid& pyramid, const PyramidIndex& index, const Points& x);

/// Its gradient: 3×3n as ElasticMap::displacement_gradient; on a face shared by two cells, of the upper one.
Points look_up_gradient(const Pyramid& pyramid, const PyramidIndex& index, const Points& x);

}  // namespace bespoke
