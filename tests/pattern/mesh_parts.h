#pragma once

#include <utility>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"
#include "support/shapes.h"

namespace bespoke::test {

/// A part of a mesh, and for every vertex its number in the whole.
struct MeshPart {
  TriangleMesh mesh;
  std::vector<int> vertices;
};

/// The faces whose centres are kept.
template <class IsKept>
MeshPart part_of(const TriangleMesh& whole, const IsKept& is_kept) {
  std::vector<int> kept;
  for (Eigen::Index f = 0; f < whole.faces.cols(); ++f)
    if (is_kept(Vector3(whole.vertices(Eigen::all, whole.faces.col(f)).rowwise().mean())))
      kept.push_back(static_cast<int>(f));
  MeshPart part{{whole.vertices, whole.faces(Eigen::all, kept)}, {}};
  std::vector<int> number(static_cast<std::size_t>(whole.vertices.cols()), -1);
  for (int& v : part.mesh.faces.reshaped()) {
    int& known = number[static_cast<std::size_t>(v)];
    if (known < 0) {
      known = static_cast<int>(part.vertices.size());
      part.vertices.push_back(v);
    }
    v = known;
  }
  part.mesh.vertices = whole.vertices(Eigen::all, part.vertices);
  return part;
}

/// A ball of radius 100 mm.
inline TriangleMesh ball() {
  TriangleMesh mesh = shapes::icosphere(4);
  mesh.vertices *= 100;
  return mesh;
}

}  // namespace bespoke::test
