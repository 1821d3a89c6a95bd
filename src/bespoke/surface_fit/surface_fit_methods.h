#pragma once

#include <array>
#include <string_view>

#include "bespoke/surface_fit/surface_fit_options.h"

namespace bespoke {

struct Progress;
struct SurfaceFit;
struct SurfaceFitInput;

using FitSurface = SurfaceFit(const SurfaceFitInput&, const SurfaceFitOptions&, const Progress&);

// As fit_surface, whose preconditions hold.
FitSurface fit_surface_laplacian;
FitSurface fit_surface_deformation_graph;

/// All there is to say about a method.
struct SurfaceFitEntry {
  std::string_view name;  ///< on the command line, in assets and in reports
  SurfaceFitMethod value;
  std::string_view summary;  ///< a few words, for help and pages
  FitSurface* fit;
};

/// Every method: to add one, add its value and its function above and its line here.
inline constexpr std::array surface_fits{
    SurfaceFitEntry{"laplacian", SurfaceFitMethod::laplacian, "the paper's smoothed displacements",
                    &fit_surface_laplacian},
    SurfaceFitEntry{"deformation-graph", SurfaceFitMethod::deformation_graph,
                    "a similarity, nodes and layers of space, coarse to fine",
                    &fit_surface_deformation_graph}};

/// Throws InvalidInput for a value that is no method.
const SurfaceFitEntry& entry_of(SurfaceFitMethod method);

}  // namespace bespoke
