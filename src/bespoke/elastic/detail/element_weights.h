#pragma once

#include <vector>

#include "bespoke/elastic/detail/nested_elements.h"
#include "bespoke/mesh/closest_point.h"

namespace bespoke {

/// How much distortion counts in the finest cells, per level (NestedElements::weigh): 1 at the surface, where
/// products are, and less the farther away, so that what must be distorted is so out there,
///
///     κ = κ₀ + (1 − κ₀)/(1 + (d/r)²),  κ₀ = 1/30, r = 0.4 λ,
///
/// d from the surface to a cell's middle. lambda > 0, mesh units. Cells that are among the finest of `before`
/// as well, whose origin and voxels are the same, keep the weights that they have there.
std::vector<std::vector<double>> element_weights(const NestedElements& elements,
                                                 const ClosestPointTree& surface, double lambda,
                                                 const NestedElements* before = nullptr);

}  // namespace bespoke
