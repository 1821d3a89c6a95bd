#include "bespoke/surface_fit/detail/crease.h"

namespace bespoke {

double crease(const FoundPair& pair, const TargetSurface& asking) {
  const Vector3 step = pair.match.point - pair.point;
  if (!(step.dot(pair.match.halfway) > 0)) return 0;
  const auto claim = nearer_claim(pair, asking, 1);
  if (!claim) return 0;
  const double bent = 1 - (claim->point - pair.match.point).squaredNorm() / step.squaredNorm();
  return bent * bent;
}

}  // namespace bespoke
