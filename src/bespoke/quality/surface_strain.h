#pragma once

#include <vector>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Root mean square logarithmic (Hencky) strain of a surface around places on it: with s₁, s₂ a face's
/// principal stretches (tenfold at most) and s² the factor of the whole area, √ (mean of ln² (s₁ / s) + ln²
/// (s₂ / s)) by area before, over the faces within `reach` (> 0, mesh units) and the place's own; 0 under a
/// similarity. registered: 3×n, vertices after. places: on the surface before. Returns one a place. Throws
/// InvalidInput for sizes that differ, values that are not finite, and surfaces without area.
Eigen::VectorXd strain_around(const TriangleMesh& surface, const Points& registered,
                              const std::vector<SurfacePoint>& places, double reach);

}  // namespace bespoke
