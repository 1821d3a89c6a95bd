#pragma once

#include <array>
#include <string>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A part of a garment that is cut out of flat cloth: a disk, that is, connected, with one boundary loop and
/// without handles.
struct Piece {
  std::string name;
  TriangleMesh mesh;  ///< millimetres
  std::vector<int>
      vertices;  ///< for every vertex of `mesh` its number in the product, copies at one place joined
  std::vector<int> faces;    ///< for every face of `mesh` its number among the product's triangles, ascending
  Eigen::Matrix2Xd texture;  ///< 2×3m, of the corners face by face; or empty
  std::vector<int> outline;  ///< vertices of the boundary loop, the surface on the left
};

/// A vertex that the product has not, inside a face or on an edge: by weights of the vertices there.
struct AddedVertex {
  std::array<int, 3> of{};
  Vector3 weights = Vector3::Zero();
};

/// One side of a seam: a part of a piece's outline.
struct SeamSide {
  int piece = 0;
  std::vector<int> vertices;  ///< of the piece's mesh; those of both sides correspond one by one
};

/// Two parts of outlines that are sewn together: in the garment they lie on the same edges.
struct Seam {
  std::array<SeamSide, 2> sides;
  double ease = 0;  ///< millimetres that the first side is longer by when flat; negative: the second
};

}  // namespace bespoke
