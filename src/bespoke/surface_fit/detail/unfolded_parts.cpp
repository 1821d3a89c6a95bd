#include "bespoke/surface_fit/detail/unfolded_parts.h"

#include <cmath>
#include <numbers>

#include "bespoke/mesh/disjoint_sets.h"
#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {
namespace {

/// An edge of exactly two faces, which can bend.
struct Hinge {
  int a, b;           // vertices
  int first, second;  // faces
};

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

/// How a surface is bent at its hinges.
class Bends {
 public:
  Bends(const Points& vertices, const Faces& faces)
      : vertices_(vertices), normals_(face_normals({vertices, faces})) {}

  /// Radians between the normals of the two faces, negative where they are bent the other way.
  double operator()(const Hinge& hinge) const {
    const Vector3 axis = (vertices_.col(hinge.b) - vertices_.col(hinge.a)).normalized();
    const Vector3 first = normals_.col(hinge.first), second = normals_.col(hinge.second);
    return std::atan2(axis.dot(first.cross(second)), first.dot(second));
  }

 private:
  const Points& vertices_;
  Points normals_;
};

bool is_fold(double bend, double meant) {
  return std::abs(std::remainder(bend - meant, 2 * std::numbers::pi)) > std::numbers::pi / 2;
}

}  // namespace

std::vector<char> unfolded_parts(const DrawnSurface& surface, const std::vector<Eigen::Index>& faces) {
  const Faces& all = surface.before.faces;
  const auto count = static_cast<std::size_t>(all.cols());
  std::vector<char> in_part(count, 0);
  if (faces.empty()) return in_part;
  for (const Eigen::Index face : faces) in_part[face] = 1;
  const std::vector<Hinge> edges = hinges(surface.before);
  DisjointSets parts(static_cast<int>(count));
  for (const Hinge& edge : edges)
    if (in_part[edge.first] && in_part[edge.second]) parts.join(edge.first, edge.second);

  const Bends shape(surface.shape, all), before(surface.before.vertices, all), after(surface.after, all);
  std::vector<char> was_folded(count, 0), is_folded(count, 0);  // by the least face of a part
  for (const Hinge& edge : edges) {
    if (!in_part[edge.first] && !in_part[edge.second]) continue;
    const int part = parts.least(in_part[edge.first] ? edge.first : edge.second);
    if (is_fold(before(edge), shape(edge))) was_folded[part] = 1;
    if (is_fold(after(edge), shape(edge))) is_folded[part] = 1;
  }
  std::vector<char> unfolded(count, 0);
  for (const Eigen::Index face : faces) {
    const int part = parts.least(static_cast<int>(face));
    unfolded[face] = was_folded[part] && !is_folded[part];
  }
  return unfolded;
}

}  // namespace bespoke
