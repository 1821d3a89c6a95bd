#include "bespoke/surface_fit/detail/reciprocity.h"

#include <cmath>

namespace bespoke {
namespace {

double distance(const FoundPair& pair) { return (pair.match.point - pair.point).norm(); }

}  // namespace

std::optional<SurfaceMatch> nearer_claim(const FoundPair& pair, const TargetSurface& asking, double share) {
  MatchLimits limits = pair.limits;
  limits.max_distance = share * distance(pair);
  limits.normal_length = 0;
  return asking.match(pair.match.point, pair.match.normal, limits);
}

double reciprocity(const FoundPair& pair, const TargetSurface& asking, const ReciprocitySettings& settings) {
  if (!(distance(pair) > settings.rounding * pair.limits.max_distance)) return 1;
  const auto claim = nearer_claim(pair, asking, settings.much_nearer);
  if (!claim) return 1;
  const double claimed = (claim->point - pair.match.point).norm();
  return std::pow(claimed / (settings.much_nearer * distance(pair)), settings.power);
}

}  // namespace bespoke
