#pragma once

#include <vector>

#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {

/// Surface fitting as a deformation, coarse to fine (default). One similarity first, refined on the surfaces;
/// where it explains the target nothing else is fitted (similarity_fit.h). Else, where the anchors turn a
/// part beyond a right angle, they bend the source first (anchor_pose.h). Then a smooth deformation of nodes
/// (node_fit.h), then layers of space (detail_layers.h), and faces that these flipped are reset
/// (misoriented_faces.h). Closest points on the target's boundary do not attract; a boundary of the source
/// meets the target's where both are plausibly the same cut (boundary_match.h). Exact anchors are met up to
/// 1e-3 of what the layers left; soft ones pull like their weight in per cent of the surface.
///
/// An anchor farther from the source's surface than the spacing of the finest nodes pulls on nothing: what
/// the nodes resolve does not reach it, and the point of the surface nearest to it is not what was paired.
/// Nearer ones cannot be told apart from their foot at that resolution; they move it as they move themselves.
///
/// Preconditions as checked by fit_surface; of the options, `epsilon` and `boundaries`. Same bytes at any
/// thread count. Throws InvalidInput for a surface without area, SolverError.
SurfaceFit fit_surface_deformation_graph(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                                         const Progress& progress);

/// The columns of the anchors (3×k) within the spacing of the finest nodes of the surface, mesh units.
std::vector<Eigen::Index> anchors_near(const TriangleMesh& surface, const Points& anchors,
                                       const NodeFitSettings& settings = {});

}  // namespace bespoke
