#include "bespoke/surface_fit/matching/informative_areas.h"

#include <algorithm>

namespace bespoke {

Eigen::VectorXd informative_areas(const TargetSurface& surface, const AreaSettings& settings) {
  const TriangleMesh& mesh = surface.mesh();
  const Points& normals = surface.normals();
  Eigen::VectorXd curvature = Eigen::VectorXd::Zero(mesh.vertices.cols());
  Eigen::VectorXd edges = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (const auto& face : mesh.faces.colwise())
    for (int k = 0; k < 3; ++k) {
      const int a = face[k], b = face[(k + 1) % 3];
      const double span = std::max((mesh.vertices.col(b) - mesh.vertices.col(a)).norm(), settings.shortest);
      const double turn = (normals.col(b) - normals.col(a)).norm() / span;
      for (const int end : {a, b}) {
        curvature[end] += turn * turn;
        edges[end] += 1;
      }
    }
  const Eigen::VectorXd& areas = surface.areas();
  Eigen::VectorXd informative(areas.size());
  const double unit = settings.length * settings.length;
  for (Eigen::Index i = 0; i < areas.size(); ++i)
    informative[i] =
        areas[i] * (1 + std::min(settings.max_weight, unit * curvature[i] / std::max(1.0, edges[i])));
  const double sum = informative.sum();
  return sum > 0 ? Eigen::VectorXd(informative * (areas.sum() / sum)) : areas;
}

}  // namespace bespoke
