#pragma once

#include "bespoke/rbf/multiscale.h"

namespace bespoke {

/// An upper bound of ‖∇u(x)‖ over all x, u(x) = Σ cⱼ φ(|x − zⱼ| / λ) with Wendland's C2 function. Where a
/// coarse bound shows that the gradient stays below `enough`, no closer look is taken.
double gradient_bound(const RbfLayer& layer, double enough);

}  // namespace bespoke
