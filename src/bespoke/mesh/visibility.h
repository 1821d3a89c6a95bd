#pragma once

#include <limits>

#include "bespoke/mesh/box_tree.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// What a straight way can meet of a face.
enum class FaceSides { front, both };

/// Straight ways from places on a surface or off it, and whether the surface is in their way. Thread-safe.
class VisibilityQuery {
 public:
  /// The mesh must outlive it, have a face and valid indices.
  explicit VisibilityQuery(const TriangleMesh& mesh);

  /// Whether a face lies before x along `direction` (unit), within `reach` (mesh units). Faces through x are
  /// not before it.
  bool is_blocked(const Vector3& x, const Vector3& direction, FaceSides sides = FaceSides::both,
                  double reach = std::numeric_limits<double>::infinity()) const;

 private:
  const TriangleMesh& mesh_;
  BoxTree tree_;
  double least_;  // mesh units: what is nearer is at x itself
};

}  // namespace bespoke
