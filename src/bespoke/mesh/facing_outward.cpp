#include "bespoke/mesh/facing_outward.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <vector>

#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {
namespace {

/// Where cones to it add no volume.
Vector3 apex_of_borders(const TriangleMesh& mesh) {
  const std::vector<char> on_border = boundary_vertices(mesh);
  Vector3 sum = Vector3::Zero();
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i)
    if (on_border[static_cast<std::size_t>(i)]) {
      sum += mesh.vertices.col(i);
      ++count;
    }
  if (count > 0) return sum / static_cast<double>(count);
  return mesh.vertices.cols() == 0 ? sum : Vector3(mesh.vertices.rowwise().mean());
}

}  // namespace

// Divergence theorem: the sum of signed cones over the faces.
double signed_volume(const TriangleMesh& mesh) {
  const Vector3 apex = apex_of_borders(mesh);
  double sum = 0;
  for (const auto& face : mesh.faces.colwise()) {
    Matrix3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = mesh.vertices.col(face[k]) - apex;
    sum += edges.determinant();
  }
  return sum / 6;
}

std::optional<bool> faces_outward(const TriangleMesh& mesh) {
  // Of the largest volume that so much area can enclose, squared: a ball's is 1, that of a wire 200 times as
  // long as it is thick .01, of a sheet that leaves its plane by a hundredth of its width .001.
  constexpr double min_quotient = 1e-3;
  const double volume = signed_volume(mesh), area = vertex_areas(mesh).sum();
  if (!(36 * std::numbers::pi * volume * volume > min_quotient * area * area * area)) return std::nullopt;
  return volume > 0;
}

}  // namespace bespoke
