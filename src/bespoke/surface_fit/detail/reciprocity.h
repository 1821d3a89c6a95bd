#pragma once

#include <optional>

#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/detail/target_surface.h"

namespace bespoke {

/// A point of a surface and what it has found on another.
struct FoundPair {
  Vector3 point;  ///< mesh units
  const SurfaceMatch& match;
  const MatchLimits& limits;  ///< that `match` is within
};

/// The place of the asking surface that is nearest to the match and faces as that does, where it is nearer
/// than `share` of the point's distance; empty also where it lies on the surface's boundary.
std::optional<SurfaceMatch> nearer_claim(const FoundPair& pair, const TargetSurface& asking, double share);

/// How near the asking surface comes to the match: c / d, with d the distance of the point and c that of the
/// nearer claim; 1 without one, and for a point on its match.
double claimed_share(const FoundPair& pair, const TargetSurface& asking, double share,
                     const ReciprocitySettings& settings);

/// How much a pair with this claimed share counts, 0 to 1. Where another place of the asking surface is much
/// nearer to the match than the point is, the match is that place's counterpart and the point has none: the
/// answering surface lacks its part, as a scan with a hole does, or one that ends at a wrist.
/// (claimed / much_nearer)^power, at most 1.
double reciprocity(double claimed, const ReciprocitySettings& settings);

}  // namespace bespoke
