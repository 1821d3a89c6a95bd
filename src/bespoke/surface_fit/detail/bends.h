#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// An edge of exactly two faces, at which a surface can bend.
struct Hinge {
  int a, b;           ///< vertices
  int first, second;  ///< faces
};

/// In time linear in the faces. Indices must be within range.
std::vector<Hinge> hinges(const TriangleMesh& mesh);

/// Radians, one per hinge, from −π to π: how much farther the two faces are bent than in the shape. What
/// turns as a whole is not bent. Shape and vertices 3×n, any units.
std::vector<double> bends(const std::vector<Hinge>& hinges, const Faces& faces, const Points& shape,
                          const Points& vertices);

}  // namespace bespoke
