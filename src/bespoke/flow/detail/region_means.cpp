#include "bespoke/flow/detail/region_means.h"

#include <vector>

#include "bespoke/rbf/point_grid.h"

namespace bespoke {
namespace {

// Of the bounding-box diagonal; half the default λ. Separates poses from wrinkles, and fingers from the hand.
constexpr double region_radius = 0.05;

}  // namespace

void for_each_region(const TriangleMesh& mesh, const Eigen::VectorXd& areas,
                     const std::function<Matrix3(Eigen::Index face)>& value,
                     const std::function<void(const Matrix3& mean)>& visit) {
  std::vector<int> used;
  for (int face = 0; face < static_cast<int>(areas.size()); ++face)
    if (areas[face] > 0) used.push_back(face);
  Points centroids(3, static_cast<Eigen::Index>(used.size()));
  for (std::size_t i = 0; i < used.size(); ++i)
    centroids.col(static_cast<Eigen::Index>(i)) =
        mesh.vertices(Eigen::all, mesh.faces.col(used[i])).rowwise().mean();
  const double radius = region_radius * diagonal(mesh.vertices);
  const PointGrid grid(centroids, radius);
  for (const int center : thin_points(centroids, radius)) {
    Matrix3 sum = Matrix3::Zero();
    double area = 0;
    grid.for_each_within(centroids.col(center), radius, [&](int i, double) {
      const int face = used[static_cast<std::size_t>(i)];
      sum += areas[face] * value(face);
      area += areas[face];
    });
    visit(sum / area);
  }
}

}  // namespace bespoke
