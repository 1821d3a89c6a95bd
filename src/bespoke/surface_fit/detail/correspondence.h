#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// What every vertex of one surface finds on another.
struct Correspondence {
  Points points;              ///< 3×n, mesh units; the vertex's own position where it found nothing
  std::vector<char> matched;  ///< n; 1 where `points` holds a compatible point
  std::size_t unmatched = 0;  ///< vertices without one
};

/// Finds the closest compatible points on one target (IV.C): the target's normal lies within 90° of the
/// vertex's. A point on the target's boundary is no counterpart: there the target ends, not the body, and all
/// that lies beyond would collapse onto the boundary curve. Thread-safe.
class CompatiblePoints {
 public:
  /// Throws InvalidInput as ClosestPointTree.
  explicit CompatiblePoints(const TriangleMesh& target);

  /// vertices, normals: 3×n, mesh units and unit vectors; a vertex without a normal (zero) finds nothing.
  /// Throws InvalidInput when the sizes differ.
  Correspondence closest(const Points& vertices, const Points& normals) const;

 private:
  bool on_boundary(const SurfacePoint& found) const;

  ClosestPointTree tree_;
  Faces faces_;
  std::vector<char> boundary_edges_;  // per face: bit k set where the edge opposite corner k has one face
  std::vector<char> boundary_vertices_;
};

}  // namespace bespoke
