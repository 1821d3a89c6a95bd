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

/// Guides at 0.4 λ from the source, about half of that apart: at v + d n for a vertex v and the mean normal n
/// of the vertices within d, or one edge, that face as v does, taken to v' + s d R n, with R the
/// least-squares rotation of these vertices and s² the factor of the whole area, which no pose changes. None
/// where another part of the source, or of the fitted source, is nearer than v: space between fingers goes as
/// these require. Nor where two guides less than d apart, before or (measured by s) after, come to lie more
/// than twice as far apart or as near: space between an arm and a hip that approach each other. fitted: 3×n;
/// lambda > 0, mesh units. Throws InvalidInput for another number of vertices and meshes that are not valid.
SpaceGuides space_guides(const TriangleMesh& source, const Points& fitted, double lambda);

}  // namespace bespoke
