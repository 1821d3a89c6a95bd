#pragma once

#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {

/// Surface fitting as a deformation, coarse to fine (default). One similarity first, refined on the surfaces;
/// where it explains the target (nine tenths of the distances within 0.05 % of the diagonal, exact anchors
/// within twice that) nothing else is fitted. Else a smooth deformation of nodes (node_fit.h), then layers of
/// space (detail_layers.h), and faces that these turned over are taken back (turned_faces.h). Closest points
/// on the target's boundary do not attract; a boundary of the source meets the target's where both are
/// plausibly the same cut (boundary_match.h). Exact anchors are met up to 1e-3 of what the layers left; soft
/// ones pull like their weight in per cent of the surface.
///
/// Preconditions as checked by fit_surface, and no option but those of `SurfaceFitOptions::epsilon`. Same
/// bytes at any thread count. Throws InvalidInput for a surface without area, SolverError.
SurfaceFit fit_surface_multiscale(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                                  const Progress& progress = {});

}  // namespace bespoke
