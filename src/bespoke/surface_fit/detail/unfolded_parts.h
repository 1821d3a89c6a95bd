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

/// One flag per face: 1 for those of `faces` in a part that was folded before and is not after. Parts are
/// connected across edges, and folded where the angle between two faces at an edge of theirs has changed by
/// more than a right angle since the shape.
std::vector<char> unfolded_parts(const DrawnSurface& surface, const std::vector<Eigen::Index>& faces);

}  // namespace bespoke
