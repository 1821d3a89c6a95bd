#pragma once

#include "bespoke/surface_fit/detail/target_surface.h"

namespace bespoke {

/// n, mesh units squared: how much of the surface each vertex speaks for in a fit of planes. A plane says
/// nothing about places along it, so bent places, which few vertices share, count more: the area around the
/// vertex times 1 + min(4, (ℓκ)²), with κ the mean over its edges of the turn of the normal a length and ℓ a
/// hundredth of `diagonal` (> 0, mesh units). Scaled to the sum of the areas.
Eigen::VectorXd informative_areas(const TargetSurface& surface, double diagonal);

}  // namespace bespoke
