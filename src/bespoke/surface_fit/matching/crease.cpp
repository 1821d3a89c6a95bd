#include "bespoke/surface_fit/matching/crease.h"

namespace bespoke {

bool may_be_creased(const FoundPair& pair) {
  return (pair.match.point - pair.point).dot(pair.match.halfway) > 0;
}

double crease(const FoundPair& pair, double back_ratio) {
  if (!may_be_creased(pair)) return 0;
  const double bent = 1 - back_ratio * back_ratio;
  return bent * bent;
}

}  // namespace bespoke
