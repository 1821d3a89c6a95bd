#include "bespoke/surface_fit/detail/informative_areas.h"

#include <algorithm>

namespace bespoke {

Eigen::VectorXd informative_areas(const TargetSurface& surface, double diagonal) {
  constexpr double length = 0.01;    // of the diagonal: bends of this radius count twice
  constexpr double most = 4;         // so that noise cannot rule
  constexpr double shortest = 1e-4;  // of the diagonal: shorter edges tell no curvature
  const TriangleMesh& mesh = surface.mesh();
  const Points& normals = surface.normals();
  Eigen::VectorXd curvature = Eigen::VectorXd::Zero(mesh.vertices.cols());
  Eigen::VectorXd edges = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (const auto& face : mesh.faces.colwise())
    for (int k = 0; k < 3; ++k) {
      const int a = face[k], b = face[(k + 1) % 3];
      const double span = std::max((mesh.vertices.col(b) - mesh.vertices.col(a)).norm(), shortest * diagonal);
      const double turn = (normals.col(b) - normals.col(a)).norm() / span;
      for (const int end : {a, b}) {
        curvature[end] += turn * turn;
        edges[end] += 1;
      }
    }
  const Eigen::VectorXd& areas = surface.areas();
  Eigen::VectorXd informative(areas.size());
  const double unit = length * length * diagonal * diagonal;
  for (Eigen::Index i = 0; i < areas.size(); ++i)
    informative[i] = areas[i] * (1 + std::min(most, unit * curvature[i] / std::max(1.0, edges[i])));
  const double sum = informative.sum();
  return sum > 0 ? Eigen::VectorXd(informative * (areas.sum() / sum)) : areas;
}

}  // namespace bespoke
