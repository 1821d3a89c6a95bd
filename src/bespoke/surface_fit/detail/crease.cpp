#include "bespoke/surface_fit/detail/crease.h"

namespace bespoke {

double crease(const FoundPair& pair, double claimed) {
  if (!((pair.match.point - pair.point).dot(pair.match.halfway) > 0)) return 0;
  const double bent = 1 - claimed * claimed;
  return bent * bent;
}

}  // namespace bespoke
