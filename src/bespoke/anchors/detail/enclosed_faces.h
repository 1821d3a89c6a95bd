#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Faces of a surface, by their numbers, rising.
struct EnclosedFaces {
  std::vector<int> inside;
  std::vector<int> crossed;  ///< the line runs through them; some are inside, some are not
};

/// The faces that a closed polyline (3×n, mesh units, on or near the surface) encloses: the side of less area
/// on the connected component that it runs on. A face belongs to the side of two of its corners at least;
/// ends of an edge are on one side if the projected line crosses the edge an even number of times. Throws
/// InvalidInput, `where` first, if the line does not separate the surface, leaves it, encloses no vertex, or
/// cuts the surface into two about equal halves.
EnclosedFaces enclosed_faces(const TriangleMesh& mesh, const Points& border, const std::string& where);

/// The mesh with the vertices at one position as one, without the faces that have less than three then.
struct WeldedMesh {
  TriangleMesh mesh;          ///< all vertices, of which some are in no face
  std::vector<int> numbers;   ///< of its faces in the mesh it was made of
  std::vector<int> first_at;  ///< n: the vertex that stands for each
};

WeldedMesh welded(const TriangleMesh& mesh);

}  // namespace bespoke
