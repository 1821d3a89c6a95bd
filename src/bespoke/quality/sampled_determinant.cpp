#include "bespoke/quality/sampled_determinant.h"

#include <Eigen/LU>
#include <algorithm>

#include "bespoke/bake/error_points.h"

namespace bespoke {

double sampled_min_determinant(const ElasticMap& map, const Pyramid& pyramid, std::size_t count) {
  constexpr std::uint64_t seed = 57;
  const Matrix3 linear = map.affine().linear;
  double least = linear.determinant();
  for (const PyramidLevel& level : pyramid.levels) {
    const Points places =
        random_points({pyramid.origin, level.voxel_size}, level.leaves, count / pyramid.levels.size(), seed);
    const Points gradients = map.displacement_gradient(places);
    for (Eigen::Index i = 0; i < places.cols(); ++i)
      least = std::min(least, Matrix3(linear + gradients.middleCols<3>(3 * i)).determinant());
  }
  return least;
}

}  // namespace bespoke
