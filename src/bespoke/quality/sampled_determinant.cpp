#include "bespoke/quality/sampled_determinant.h"

#include <Eigen/LU>
#include <algorithm>

#include "bespoke/bake/error_points.h"

namespace bespoke {

double sampled_min_determinant(const ElasticMap& map, const std::vector<const Pyramid*>& pyramids,
                               std::size_t count) {
  constexpr std::uint64_t seed = 57;
  const Matrix3 linear = map.affine().linear;
  double found = linear.determinant();
  std::size_t levels = 0;
  for (const Pyramid* pyramid : pyramids) levels += pyramid->levels.size();
  for (const Pyramid* pyramid : pyramids)
    for (const PyramidLevel& level : pyramid->levels) {
      const Points places =
          random_points({pyramid->origin, level.voxel_size}, level.leaves, count / levels + 1, seed);
      const Points gradients = map.displacement_gradient(places);
      for (Eigen::Index i = 0; i < places.cols(); ++i)
        found = std::min(found, Matrix3(linear + gradients.middleCols<3>(3 * i)).determinant());
    }
  return found;
}

}  // namespace bespoke
