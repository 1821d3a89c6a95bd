#pragma once

#include <vector>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// How far a surface was stretched or squeezed around places on it: with s₁, s₂ a face's principal stretches
/// and s² the factor of the whole surface's area,
///   √ (mean of ln² (s₁ / s) + ln² (s₂ / s)),
/// by area before, over the faces whose centre lies within `reach` of the place, and the place's own. 0
/// under a similarity; ln 2 where all is twice as long in one direction. A stretch counts as tenfold at most.
///
/// `registered`: 3×n, the surface's vertices after. `places`: on the surface before; `reach` > 0, mesh units.
/// Faces without area before do not count. Returns a value a place. Throws InvalidInput when the sizes
/// differ, a value is not finite, or the surface has no area before or after.
Eigen::VectorXd strain_around(const TriangleMesh& surface, const Points& registered,
                              const std::vector<SurfacePoint>& places, double reach);

}  // namespace bespoke
