#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Where two fits, of either surface onto the other, put some vertices of the source.
struct TwoWayPoints {
  Points middles;         ///< 3×k, between the two places, mesh units
  Eigen::VectorXd apart;  ///< k, the distance between them, mesh units: what the surfaces leave open
};

/// `registered`: 3×n, the source's vertices on the target, in the target's frame. `target_registered`: 3×m,
/// the target's vertices on the source, in the source's frame. `vertices`: k of the source's. The second
/// place of a vertex is the point of the target that lies nearest to it once the target is registered to the
/// source.
TwoWayPoints two_way_points(const TriangleMesh& source, const Points& registered, const TriangleMesh& target,
                            const Points& target_registered, const std::vector<int>& vertices);

}  // namespace bespoke
