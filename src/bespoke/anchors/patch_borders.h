#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A line around faces of a mesh.
struct FaceBorder {
  Points line;  ///< 3×n, a polyline, mesh units
  bool closed = true;
};

/// The lines between these faces (by their numbers) and the others, through the middles of the edges between
/// them, so that a zigzag of edges gives a straight line; with the faces on the left, seen from outside. A
/// line that ends on the mesh's own boundary is open, and the boundary is no border. Vertices at one position
/// count as one.
std::vector<FaceBorder> borders_of_faces(const TriangleMesh& mesh, const std::vector<int>& faces);

/// A border of a patch and its counterpart, as a curve with the patch's name.
struct PatchBorder {
  std::size_t patch = 0;
  AnchorCurve curve;
};

/// Of all patches that do not exclude. Several borders of a patch belong together as they lie when the pairs
/// are moved rigidly. A patch that is a whole connected piece of its model has no border. Throws InvalidInput
/// naming a patch that has not as many borders on both models; and, where several are to be told apart, for
/// fewer than three pairs or collinear ones.
std::vector<PatchBorder> patch_borders(const Anchors& anchors, const TriangleMesh& source,
                                       const TriangleMesh& target);

}  // namespace bespoke
