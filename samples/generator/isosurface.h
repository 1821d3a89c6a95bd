#pragma once

#include "bespoke/mesh/triangle_mesh.h"
#include "solid.h"

namespace bespoke {

struct Lattice {
  Box box;                                 ///< cm, contains the surface
  double spacing = 1;                      ///< cm
  Matrix3 rotation = Matrix3::Identity();  ///< of the lattice's axes
};

/// The connected zero surface of the field that the +x ray from `inside` meets first: closed, manifold,
/// outward, with a vertex on each crossed edge of the lattice's tetrahedra. Throws InvalidInput if there is
/// none or if it leaves the box. Not by OpenVDB, whose grids hold the field as floats: samples keep their
/// bytes.
TriangleMesh isosurface(const Field& field, const Vector3& inside, const Lattice& lattice);

/// The part of the mesh where `keep` is negative. Crossing triangles are cut; no vertex is left unreferenced.
TriangleMesh clip(const TriangleMesh& mesh, const Field& keep);

}  // namespace bespoke
