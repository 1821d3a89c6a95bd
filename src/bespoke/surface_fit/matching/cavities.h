#pragma once

#include <vector>

#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/matching/target_surface.h"

namespace bespoke {

/// One per vertex of the source: whether it lies in a cavity (mouth, eye socket, nostril) that the target
/// lacks, so that it has no counterpart. Such a vertex faces the source itself, its closest compatible target
/// point faces nothing of the target, and an exposed place of the source is much nearer to that point.
/// Otherwise the cavity would be flattened under the skin. source: aligned, roughly fitted.
std::vector<char> vertices_in_unmatched_cavities(const TargetSurface& source, const TargetSurface& target,
                                                 const CavitySettings& settings);

}  // namespace bespoke
