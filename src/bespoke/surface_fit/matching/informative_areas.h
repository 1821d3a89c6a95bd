#pragma once

#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/matching/target_surface.h"

namespace bespoke {

/// n, diagonals squared: how much of the surface each vertex represents in a fit of planes. A plane says
/// nothing about places along it, so bent places, which few vertices share, count more: the area around the
/// vertex times 1 + min(most, (ℓκ)²), with κ the root mean square over its edges of the turn of the normal a
/// length and ℓ a length, both of the settings. Scaled to the sum of the areas.
Eigen::VectorXd informative_areas(const TargetSurface& surface, const AreaSettings& settings = {});

}  // namespace bespoke
