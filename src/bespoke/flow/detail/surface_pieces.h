#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A connected part of a surface, or a single vertex of no face with area.
struct SurfacePiece {
  std::vector<int> vertices;  ///< increasing
  std::vector<int> faces;     ///< increasing, those without area included
  double area = 0;            ///< squared mesh units
};

/// areas: m, of the faces; those with 0 connect nothing. The largest piece comes first, equal ones in the
/// order of their first vertices.
std::vector<SurfacePiece> surface_pieces(const TriangleMesh& mesh, const Eigen::VectorXd& areas);

/// What holds a piece to the surface around it: one of its vertices, and the nearest point of a larger piece.
struct PieceLink {
  int vertex = 0;
  int face = 0;         ///< of a larger piece, with area
  Vector3 barycentric;  ///< of the nearest point on that face

  Vector3 foot(const TriangleMesh& mesh, const Points& vertices) const {
    return vertices(Eigen::all, mesh.faces.col(face)) * barycentric;
  }
};

/// Per piece, in the order given (`surface_pieces`): none for the first, a few for every other one. Pieces of
/// at least a tenth of the first one's area are linked to all before them, the many small ones (eyes, teeth,
/// hair) to those.
std::vector<std::vector<PieceLink>> piece_links(const TriangleMesh& mesh, const Eigen::VectorXd& areas,
                                                const std::vector<SurfacePiece>& pieces);

}  // namespace bespoke
