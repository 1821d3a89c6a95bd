#include "bespoke/mesh/spread_points.h"

#include <limits>

namespace bespoke {
namespace {

/// Farthest-point sampling (Gonzalez 1985).
/// nearest: n, squared distances to begin with; points at 0 are not chosen.
std::vector<int> spread_from(const Points& points, Eigen::VectorXd nearest, std::size_t count) {
  std::vector<int> chosen;
  Eigen::Index next = 0;
  while (chosen.size() < count && nearest.size() > 0 && nearest.maxCoeff(&next) > 0) {
    chosen.push_back(static_cast<int>(next));
    nearest = nearest.cwiseMin((points.colwise() - points.col(next)).colwise().squaredNorm().transpose());
  }
  return chosen;
}

Eigen::VectorXd far_away(Eigen::Index count) {
  return Eigen::VectorXd::Constant(count, std::numeric_limits<double>::infinity());
}

}  // namespace

std::vector<int> spread_points(const Points& points, std::size_t count) {
  return spread_from(points, far_away(points.cols()), count);
}

std::vector<int> spread_vertices(const TriangleMesh& mesh, std::size_t count) {
  const Eigen::VectorXd areas = vertex_areas(mesh);
  return spread_from(mesh.vertices,
                     (areas.array() > 0).select(far_away(areas.size()), Eigen::VectorXd::Zero(areas.size())),
                     count);
}

}  // namespace bespoke
