#include "bespoke/surface_fit/detail/reciprocity.h"

#include <algorithm>
#include <cmath>

namespace bespoke {
namespace {

double distance(const FoundPair& pair) { return (pair.match.point - pair.point).norm(); }

}  // namespace

/// Reciprocal correspondences (Pajdla, Van Gool 1995).
std::optional<SurfaceMatch> nearer_claim(const FoundPair& pair, const TargetSurface& asking, double share) {
  MatchLimits limits = pair.limits;
  limits.max_distance = share * distance(pair);
  limits.normal_length = 0;
  return asking.match(pair.match.point, pair.match.normal, limits);
}

double claimed_share(const FoundPair& pair, const TargetSurface& asking, double share,
                     const ReciprocitySettings& settings) {
  if (!(distance(pair) > settings.rounding * pair.limits.max_distance)) return 1;
  const auto claim = nearer_claim(pair, asking, share);
  return claim ? (claim->point - pair.match.point).norm() / distance(pair) : 1;
}

double reciprocity(double claimed, const ReciprocitySettings& settings) {
  return std::pow(std::min(claimed / settings.much_nearer, 1.0), settings.power);
}

}  // namespace bespoke
