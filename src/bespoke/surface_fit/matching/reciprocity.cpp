#include "bespoke/surface_fit/matching/reciprocity.h"

#include <algorithm>
#include <cmath>

namespace bespoke {
namespace {

double distance(const FoundPair& pair) { return (pair.match.point - pair.point).norm(); }

}  // namespace

/// Reciprocal correspondences (Pajdla, Van Gool 1995).
std::optional<SurfaceMatch> back_match(const FoundPair& pair, const TargetSurface& surface, double share) {
  MatchLimits limits = pair.limits;
  limits.max_distance = share * distance(pair);
  limits.normal_length = 0;
  return surface.match(pair.match.point, pair.match.normal, limits);
}

double back_distance_ratio(const FoundPair& pair, const TargetSurface& surface, double share,
                           const ReciprocitySettings& settings) {
  if (!(distance(pair) > settings.rounding * pair.limits.max_distance)) return 1;
  const auto found = back_match(pair, surface, share);
  return found ? (found->point - pair.match.point).norm() / distance(pair) : 1;
}

double reciprocity(double ratio, const ReciprocitySettings& settings) {
  return std::pow(std::min(ratio / settings.much_nearer, 1.0), settings.power);
}

}  // namespace bespoke
