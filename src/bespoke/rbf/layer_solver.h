#pragma once

#include "bespoke/rbf/rbf_layer.h"

namespace bespoke {

/// The layer of radius lambda (mesh units) on these centers (3×m, no two closer than some λ/4, mesh units)
/// that takes `values` (3×m, mesh units) there, with Wendland's C2 function; conjugate gradients down to
/// `tolerance` (mesh units) or one thousandth of the largest value. Throws SolverError.
RbfLayer solve_layer(const Points& centers, const Points& values, double lambda, double tolerance);

struct SmoothLayerOptions {
  double ridge = 1e-3;     ///< added to the kernel's diagonal of 1: bounds the condition at some 1e4
  int max_steps = 40;      ///< of conjugate gradients
  double residual = 1e-6;  ///< of the squared right-hand side: a thousandth of the values
};

/// Coefficients (3×m) of Wendland's C4 functions of radius lambda (mesh units) at these centres (3×m, mesh
/// units, in any positions) that take `values` (3×m) there up to the ridge.
Points smooth_layer(const Points& centers, const Points& values, double lambda,
                    const SmoothLayerOptions& options = {});

}  // namespace bespoke
