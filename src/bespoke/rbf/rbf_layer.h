#pragma once

#include "bespoke/types.h"

namespace bespoke {

/// One scale: Σ cⱼ φ(|x − zⱼ|/λ).
struct RbfLayer {
  double lambda = 0;    ///< support radius, mesh units
  Points centers;       ///< 3×m, mesh units
  Points coefficients;  ///< 3×m, mesh units
};

}  // namespace bespoke
