#pragma once

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// How far a deformation turns whole parts of a surface, and stretches them against the whole.
struct RegionalMotion {
  double turn = 0;     ///< largest rotation of a region, radians
  double stretch = 1;  ///< largest factor, or one over it, by which a region is stretched
                       ///< more than the surface as a whole (growth, triangle_mesh.h), ≥ 1
};

/// By the gradients of the faces alone: area-weighted means over balls of 5 % of the source's bounding-box
/// diagonal separate limbs that turn from faces that a fit has tilted. Rotations lie in [0, π] (SurfacePath
/// resolves larger ones). fitted: 3×n, the whole's rigid motion removed, mesh units.
RegionalMotion regional_motion(const TriangleMesh& source, const Points& fitted);

/// Into how many steps a motion is divided so that each is small enough for one elastic map: 1 up to 60° and
/// threefold stretch, which one map has always done well; beyond, 30° and a 1.5-fold stretch each at most.
int step_count(const RegionalMotion& motion);

}  // namespace bespoke
