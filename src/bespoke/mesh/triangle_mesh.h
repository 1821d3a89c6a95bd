#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// Triangles over shared vertices. May be open, non-manifold and of several components.
struct TriangleMesh {
  Points vertices;  ///< 3×n, mesh units
  Faces faces;      ///< 3×m, indices into the columns of `vertices`
};

/// What a mesh is made of, for messages and reports. Computed, never repaired.
struct MeshFindings {
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t components = 0;             ///< of faces connected through shared vertices
  std::size_t boundary_edges = 0;         ///< edges of exactly one face
  std::size_t non_manifold_edges = 0;     ///< edges of three faces and more
  std::size_t inconsistent_edges = 0;     ///< edges that two faces run through in the same direction
  std::size_t degenerate_faces = 0;       ///< area at most 1e-14 of the squared bounding-box diagonal
  std::size_t unreferenced_vertices = 0;  ///< in no face
  std::size_t duplicate_vertices = 0;     ///< at exactly the position of an earlier vertex
};

/// Throws InvalidInput when a face's index is out of range; the functions below presume it is not.
MeshFindings inspect_mesh(const TriangleMesh& mesh);

/// One line, for instance "13380 vertices, 26756 faces, 1 component, closed"; names only what is unusual.
std::string to_string(const MeshFindings& findings);

/// Throws InvalidInput, naming `what` (for instance "source body.obj"), unless the mesh has at least one
/// face, only finite coordinates, only indices within range, and a positive, finite bounding-box diagonal.
void require_valid(const TriangleMesh& mesh, const std::string& what);

/// Axis-aligned bounding box of all columns; empty for no columns.
Box bounding_box(const Points& points);

/// Length of the bounding box's diagonal, mesh units; 0 for no columns.
double diagonal(const Points& points);

/// Between points in the same columns.
std::vector<double> distances(const Points& from, const Points& to);

/// 3×m unit normals, one per face; zero for a face without area.
Points face_normals(const TriangleMesh& mesh);

/// 3×n unit normals, one per vertex, faces weighted by the angle at the vertex; zero where undefined.
Points vertex_normals(const TriangleMesh& mesh);

/// The same where face_normals() of the mesh are known: 3×m.
Points vertex_normals(const TriangleMesh& mesh, const Points& of_faces);

/// n: a third of the area of the faces around each vertex, mesh units squared.
Eigen::VectorXd vertex_areas(const TriangleMesh& mesh);

/// How many times as large the surface is with its vertices at `moved` (3×n): the square root of the factor
/// of its whole area, which no pose changes. 1 for a surface without area, before or after.
double growth(const TriangleMesh& mesh, const Points& moved);

/// SHA-256 of the vertices, rounded to floats but hashed as doubles, and of the faces' indices, lower-case
/// hex: names a model in an asset, whatever its file was called, in whichever format, with however many
/// digits.
std::string content_hash(const TriangleMesh& mesh);

}  // namespace bespoke
