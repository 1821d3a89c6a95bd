#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <array>
#include <string>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

struct HalfEdgeTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};

/// Topology: one-rings, loops, edits of edges. OpenMesh's headers take 2 s to compile, so sources include
/// this one, headers do not.
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<HalfEdgeTraits>;

/// Where a mesh is no oriented manifold, possibly with boundary. All in increasing order.
struct NonManifoldPlaces {
  std::vector<std::array<int, 2>> edges;  ///< (a, b), a < b: of three faces, or of two that run the same way
  std::vector<int> vertices;              ///< whose faces form several fans, although their edges are good
  std::vector<int> faces;                 ///< that name a vertex twice

  bool empty() const { return edges.empty() && vertices.empty() && faces.empty(); }
};

/// Linear in the faces. Indices must be within range.
NonManifoldPlaces non_manifold_places(const TriangleMesh& mesh);

/// One line that names the first of each kind, vertices counted from 1: "3 non-manifold edges (the first
/// between vertices 4 and 7)"; empty for a manifold.
std::string to_string(const NonManifoldPlaces& places);

/// Vertices and faces keep their numbers, faces their first corners. Throws InvalidInput with the places that
/// are not manifold, if there are any: see split_to_manifold.
HalfEdgeMesh half_edge_mesh(const TriangleMesh& mesh);

/// The inverse; elements that were deleted are left out, the others keep their order.
TriangleMesh triangle_mesh(const HalfEdgeMesh& mesh);

/// A mesh of the same faces in which vertices have become several.
struct SplitMesh {
  TriangleMesh mesh;         ///< the vertices of the whole first; then the copies
  std::vector<int> origins;  ///< for every vertex of `mesh` its number in the whole
};

/// Opens edges and vertices that are not manifold: faces stay connected across good edges only. Throws
/// InvalidInput for faces that name a vertex twice.
SplitMesh split_to_manifold(const TriangleMesh& mesh);

/// Opens the edges between the vertices (a, b), whose faces stay connected elsewhere; a path that ends inside
/// the surface stays closed at its end. Throws InvalidInput for a pair that is no edge.
SplitMesh split_at_edges(const TriangleMesh& mesh, const std::vector<std::array<int, 2>>& edges);

/// Vertices of each boundary loop, with the surface on the left; every loop begins at its least vertex, loops
/// in the order of these.
std::vector<std::vector<int>> boundary_loops(const HalfEdgeMesh& mesh);

}  // namespace bespoke
