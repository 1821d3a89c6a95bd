#include "bespoke/surface_fit/detail/bends.h"

#include <cmath>
#include <numbers>

#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {
namespace {

/// Radians between the normals of the two faces, negative where they are bent the other way.
double angle(const Hinge& hinge, const Points& vertices, const Points& normals) {
  const Vector3 axis = (vertices.col(hinge.b) - vertices.col(hinge.a)).normalized();
  const Vector3 first = normals.col(hinge.first), second = normals.col(hinge.second);
  return std::atan2(axis.dot(first.cross(second)), first.dot(second));
}

}  // namespace

std::vector<Hinge> hinges(const TriangleMesh& mesh) {
  const MeshEdges edges = mesh_edges(mesh);
  std::vector<int> first(edges.edges.size(), MeshEdges::none);
  std::vector<Hinge> found;
  for (int face = 0; face < static_cast<int>(mesh.faces.cols()); ++face)
    for (const int index : edges.of_face.col(face)) {
      if (index == MeshEdges::none) continue;
      const MeshEdge& edge = edges.edges[index];
      if (edge.faces() != 2) continue;
      if (first[index] == MeshEdges::none)
        first[index] = face;
      else
        found.push_back({edge.a, edge.b, first[index], face});
    }
  return found;
}

std::vector<double> bends(const std::vector<Hinge>& hinges, const Faces& faces, const Points& shape,
                          const Points& vertices) {
  const Points shape_normals = face_normals({shape, faces}), normals = face_normals({vertices, faces});
  std::vector<double> all;
  all.reserve(hinges.size());
  for (const Hinge& hinge : hinges)
    all.push_back(std::remainder(angle(hinge, vertices, normals) - angle(hinge, shape, shape_normals),
                                 2 * std::numbers::pi));
  return all;
}

}  // namespace bespoke
