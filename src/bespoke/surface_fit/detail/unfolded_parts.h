#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A surface that a smooth deformation has brought to a place, and then was drawn farther. Mesh units.
struct DrawnSurface {
  const Points& shape;         ///< 3×n, where it came from: as it is meant to bend
  const TriangleMesh& before;  ///< as the smooth deformation left it
  const Points& after;         ///< 3×n, as it was drawn
};

/// Of `faces` those in parts that were folded before and are so no longer, in increasing order. Parts are
/// connected across edges. One is unfolded where Σ |edge| (change of the angle between its two faces)², on
/// the shape and since, over all edges of the part, is less after than before.
std::vector<Eigen::Index> unfolded_parts(const DrawnSurface& surface, const std::vector<Eigen::Index>& faces);

}  // namespace bespoke
