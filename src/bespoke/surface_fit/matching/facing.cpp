#include "bespoke/surface_fit/matching/facing.h"

#include <algorithm>

#include "bespoke/mesh/closest_point.h"

namespace bespoke {

bool faces_away(const TriangleMesh& source, const TriangleMesh& target) {
  constexpr Eigen::Index max_vertices = 2000;
  const ClosestPointTree tree(target);
  const Points normals = vertex_normals(source), target_normals = face_normals(target);
  const Eigen::Index stride = std::max<Eigen::Index>(1, normals.cols() / max_vertices);
  Eigen::Index sampled = 0, against = 0;
  for (Eigen::Index i = 0; i < normals.cols(); i += stride, ++sampled) {
    const auto nearest = tree.closest(source.vertices.col(i));
    against += nearest && target_normals.col(nearest->face).dot(normals.col(i)) < 0;
  }
  return 3 * against > 2 * sampled;
}

TriangleMesh flipped(TriangleMesh mesh) {
  mesh.faces.row(1).swap(mesh.faces.row(2));
  return mesh;
}

}  // namespace bespoke
