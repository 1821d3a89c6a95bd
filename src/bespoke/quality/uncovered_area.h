#pragma once

#include <string>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// What of a target is far from a source registered to it, although the source goes on there: where the
/// source ends, at an open boundary, the target may go on alone.
struct UncoveredArea {
  double share = 0;     ///< of the target's area
  double distance = 0;  ///< of the farthest place there from the source, mesh units; 0 without any
  Vector3 farthest = Vector3::Zero();  ///< that place, mesh units

  /// Worth reporting: more than pairs with all their anchors leave (tests/accuracy/tuning.md).
  bool is_notable() const { return share > 0.01; }
};

/// reach: mesh units, > 0: what is nearer is covered. By 5,000 samples of equal area. Throws InvalidInput
/// for meshes that are not valid.
UncoveredArea uncovered_area(const TriangleMesh& target, const TriangleMesh& registered, double reach);

/// "2.9 % of the target is uncovered, at most 9.3 from the source, at (1, 2, 3)"
std::string to_string(const UncoveredArea& uncovered);

}  // namespace bespoke
