#pragma once

#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {

/// The paper's surface fitting (IV.C), from the source after the coarse warp on. Each iteration finds the
/// closest compatible points c of the vertices v (normals within 90°): T⁰ = c − v; solves (I + L) T = T⁰ (Eq.
/// 13, the minimum of Eq. 11); moves v by T. Ends at ‖T⁰‖ ≤ ε (root mean square, of the diagonal) or at the
/// cap on iterations, which real scans need; then matched vertices snap to c. LaplacianAdditions
/// (surface_fit.h) has what is not printed. Input and errors as fit_surface.
SurfaceFit fit_surface_laplacian(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                                 const Progress& progress);

}  // namespace bespoke
