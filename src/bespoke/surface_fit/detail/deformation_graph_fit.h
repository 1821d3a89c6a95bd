#pragma once

#include <vector>

#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {

/// The default surface fit; its steps in order: similarity_fit.h (the end where it explains the target),
/// anchor_pose.h (where anchors turn a part beyond a right angle), node_fit.h, detail_layers.h,
/// misoriented_faces.h. Exact anchors are met up to 1e-3 of what the layers left; soft ones weigh as per cent
/// of the surface; those farther from it than the finest nodes' spacing do not pull. Of the options it takes
/// `epsilon` and `boundaries`. Same bytes at any thread count. Throws InvalidInput without area, SolverError.
SurfaceFit fit_surface_deformation_graph(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                                         const Progress& progress);

/// The columns of the anchors (3×k) within the spacing of the finest nodes of the surface, mesh units.
std::vector<Eigen::Index> anchors_near(const TriangleMesh& surface, const Points& anchors,
                                       const NodeFitSettings& settings = {});

}  // namespace bespoke
