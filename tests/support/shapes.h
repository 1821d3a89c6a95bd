#pragma once

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke::shapes {

/// One face, counter-clockwise in the plane z = 0: (0,0,0), (1,0,0), (0,1,0).
TriangleMesh triangle();

/// Eight vertices, twelve faces, outward; lower corner at the origin.
TriangleMesh cube(double edge = 1);

/// Vertices at radius 1 exactly up to rounding; 20·4^levels faces, outward, closed.
TriangleMesh icosphere(int levels);

/// n×n squares of two triangles each over [0, 1]², normals +z.
TriangleMesh square_grid(int n);

/// Every face as four: a new vertex in the middle of every edge, after the old ones. Meshes of the same faces
/// get the same new faces.
TriangleMesh subdivided(const TriangleMesh& mesh);

/// Both meshes as one, b's vertices after a's.
TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b);

/// Every corner of a face a vertex of its own: face k has the vertices 3k, 3k + 1, 3k + 2.
TriangleMesh soup(const TriangleMesh& mesh);

/// Scaled about the origin so that the diagonal of its bounding box is 1.
TriangleMesh of_unit_diagonal(TriangleMesh mesh);

/// The mesh with all vertices mapped.
TriangleMesh moved(TriangleMesh mesh, const AffineMap& map);

}  // namespace bespoke::shapes
