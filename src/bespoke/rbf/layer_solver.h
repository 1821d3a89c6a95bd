#pragma once

#include "bespoke/rbf/rbf_layer.h"

namespace bespoke {

/// The layer of radius lambda (mesh units) on these centers (3×m, no two closer than some λ/4, mesh units)
/// that takes `values` (3×m, mesh units) there, with Wendland's C2 function; conjugate gradients down to
/// `tolerance` (mesh units) or one thousandth of the largest value. Throws SolverError.
RbfLayer solve_layer(const Points& centers, const Points& values, double lambda, double tolerance);

}  // namespace bespoke
