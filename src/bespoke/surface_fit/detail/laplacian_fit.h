#pragma once

#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {

/// The paper's surface fitting (IV.C). From the source after the coarse warp on:
///   1. every vertex v finds the closest compatible point c on the target, normals within 90°: T⁰ = c − v;
///   2. (I + L) T = T⁰ (Eq. 13) smooths the displacements, which is the minimum of Eq. 11;
///   3. v moves by T; again from 1, until ‖T⁰‖ ≤ ε;
///   4. every vertex that has a compatible point snaps onto it.
/// ‖T⁰‖ is taken as the root mean square over the vertices and ε as a fraction of the diagonal, so that
/// neither depends on the unit or on the resolution. LaplacianAdditions (surface_fit.h) names all that is not
/// printed, beside the cap on iterations, which no option takes away: on real scans ‖T⁰‖ never falls below ε.
/// Input and errors as fit_surface.
SurfaceFit fit_surface_laplacian(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                                 const Progress& progress);

}  // namespace bespoke
