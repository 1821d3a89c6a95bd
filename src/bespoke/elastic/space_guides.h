#pragma once

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Points of space outside of a surface, and where they go if space moves with the surface beneath them as a
/// rigid body does. A map that meets the surface alone takes space along the less the farther it is: its
/// layers fade, so a loose sleeve lags behind its arm.
struct SpaceGuides {
  Points sources;     ///< 3×g, mesh units
  Points targets;     ///< 3×g
  double offset = 0;  ///< from the surface, mesh units
};

/// Guides at v + d n, d = 0.4 λ, about d/2 apart, taken to v' + s d R n: n the mean normal of the vertices
/// within d that face as v does, R their least-squares rotation, s² the factor of the whole area. None where
/// another part of the source or of the fitted source is nearer than v, nor where two guides less than d
/// apart would change their distance more than twofold. fitted: 3×n; lambda > 0, mesh units. Throws
/// InvalidInput for another number of vertices and for invalid meshes.
SpaceGuides space_guides(const TriangleMesh& source, const Points& fitted, double lambda);

}  // namespace bespoke
