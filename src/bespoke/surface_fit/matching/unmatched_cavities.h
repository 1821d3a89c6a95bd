#pragma once

#include <vector>

#include "bespoke/mesh/cavities.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/surface_fit/deformation_graph_settings.h"

namespace bespoke {

/// Those of the source's cavities that the target lacks: within a cavity's radius about its middle, as the
/// source lies now (mesh units), the target's cavities have less than a share of its area. `in_cavity`: the
/// target's vertices in cavities.
std::vector<Cavity> unmatched_cavities(const std::vector<Cavity>& cavities, const TriangleMesh& source,
                                       const TriangleMesh& target, const std::vector<char>& in_cavity,
                                       const UnmatchedCavitySettings& settings);

/// One surface twice, with the same faces; mesh units.
struct RegisteredSurface {
  const TriangleMesh& source;
  const Points& fitted;  ///< 3×n: its registered vertices
};

/// Moves cavities with the space around them: each by the warp |r|³ of places of the exposed surface around
/// it to their registered ones; the residual at its boundary is extended into it. As part of the surface it
/// would keep its shape and come through a cheek that is thinner on the target. A cavity without enough
/// surface around it stays. `in_cavity`: n, the source's vertices in any cavity. Returns all vertices, 3×n.
/// Throws SolverError.
Points carried_by_space(const RegisteredSurface& registered, const std::vector<Cavity>& cavities,
                        const std::vector<char>& in_cavity, const UnmatchedCavitySettings& settings);

}  // namespace bespoke
