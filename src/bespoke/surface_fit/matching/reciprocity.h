#pragma once

#include <optional>

#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/matching/target_surface.h"

namespace bespoke {

/// A point of a surface and what it has found on another.
struct FoundPair {
  Vector3 point;  ///< mesh units
  const SurfaceMatch& match;
  const MatchLimits& limits;  ///< that `match` is within
};

/// Reciprocal correspondence: the place of the point's own surface that is nearest to the match
/// and faces as that does, where it is nearer than `share` of the point's distance; empty also where it lies
/// on the surface's boundary.
std::optional<SurfaceMatch> back_match(const FoundPair& pair, const TargetSurface& surface, double share);

/// Ratio c / d of the back distance c, from the match to its reciprocal correspondence, to the distance d of
/// the point from its match; 1 without one, and for a point on its match.
double back_distance_ratio(const FoundPair& pair, const TargetSurface& surface, double share,
                           const ReciprocitySettings& settings);

/// Weight of a pair with this ratio of back distance to distance: (ratio / much_nearer)^power, at most 1.
/// Where another place of the point's own surface is much nearer to the match, the match is that place's
/// counterpart and the point has none: the other surface lacks its part, as a scan with a hole does.
double reciprocity(double ratio, const ReciprocitySettings& settings);

}  // namespace bespoke
