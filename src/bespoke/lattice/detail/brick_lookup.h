#pragma once

#include <span>

#include "bespoke/lattice/brick_atlas.h"

namespace bespoke {

/// u at points: `x` and `u` hold three doubles a point, mesh units, and may be the same; NaN where x is not
/// finite, zero outside all bricks. The same bits with every instruction set and at any number of threads.
/// Throws InvalidInput when the sizes differ or are no multiple of three.
void look_up(const BrickAtlas& atlas, std::span<const double> x, std::span<double> u);

/// Its gradient: nine doubles a point, columns as in ElasticMap::displacement_gradient; on a face shared by
/// two cells, of the upper one.
void look_up_gradient(const BrickAtlas& atlas, std::span<const double> x, std::span<double> gradient);

}  // namespace bespoke
