#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Faces of a surface, by their numbers, rising.
struct EnclosedFaces {
  std::vector<int> inside;
  std::vector<int> crossed;  ///< the line runs through them; some are inside, some are not
};

/// The faces that a closed polyline (3×n, mesh units, on the surface or near it) encloses: of the two sides
/// of the line, on the connected piece of the surface that it runs on, the one with less area. A face belongs
/// to the side of two of its corners at least. Vertices at one position count as one.
///
/// The line is projected onto the surface as a path from face to face. Every vertex is on one side, two ends
/// of an edge on the same one if the path crosses the edge an even number of times; where no such choice
/// exists the line does not separate the surface. Throws InvalidInput, `where` first, if so, if the line
/// leaves the surface, encloses no vertex, or cuts the surface in two about equal halves.
EnclosedFaces enclosed_faces(const TriangleMesh& mesh, const Points& border, const std::string& where);

/// The mesh with the vertices at one position as one, without the faces that have less than three then.
struct WeldedMesh {
  TriangleMesh mesh;          ///< all vertices, of which some are in no face
  std::vector<int> numbers;   ///< of its faces in the mesh it was made of
  std::vector<int> first_at;  ///< n: the vertex that stands for each
};

WeldedMesh welded(const TriangleMesh& mesh);

}  // namespace bespoke
