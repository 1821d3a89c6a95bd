#include "bespoke/registration/detail/two_way_points.h"

#include "bespoke/mesh/closest_point.h"
#include "bespoke/parallel.h"

namespace bespoke {

TwoWayPoints two_way_points(const TriangleMesh& source, const Points& registered, const TriangleMesh& target,
                            const Points& target_registered, const std::vector<int>& vertices) {
  const ClosestPointTree tree({target_registered, target.faces});
  const auto count = static_cast<Eigen::Index>(vertices.size());
  TwoWayPoints points{Points(3, count), Eigen::VectorXd(count)};
  parallel_for(vertices.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const SurfacePoint foot = *tree.closest(source.vertices.col(vertices[i]));
      const Vector3 other = carried(foot, target.faces, target.vertices);
      const Vector3 one = registered.col(vertices[i]);
      points.apart[k] = (other - one).norm();
      points.middles.col(k) = (one + other) / 2;
    }
  });
  return points;
}

}  // namespace bespoke
