#pragma once

#include <vector>

#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/detail/target_surface.h"

namespace bespoke {

/// One per vertex of the source: whether it lies in a cavity that the target lacks (a mouth, eye sockets,
/// nostrils), so that nothing on the target is its counterpart. Such a vertex faces the source itself, where
/// the nearest compatible point of the target faces nothing of the target, and another place of the source,
/// in the open, is much nearer to that point. Drawn there, the cavity would lie flat under the skin around
/// its mouth, and no map without folds could follow. What sees out of a cavity keeps its counterpart.
/// source: aligned and roughly fitted; diagonal: of the aligned source, mesh units.
std::vector<char> vertices_in_lacking_cavities(const TargetSurface& source, const TargetSurface& target,
                                               double diagonal, const CavitySettings& settings);

}  // namespace bespoke
