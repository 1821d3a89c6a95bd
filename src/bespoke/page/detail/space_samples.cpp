#include "bespoke/page/detail/space_samples.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace bespoke {

Points SpaceLattice::nodes() const {
  Points points(3, static_cast<Eigen::Index>(size[0]) * size[1] * size[2]);
  Eigen::Index next = 0;
  for (int i = 0; i < size[0]; ++i)
    for (int j = 0; j < size[1]; ++j)
      for (int k = 0; k < size[2]; ++k) points.col(next++) = lattice({i, j, k});
  return points;
}

SpaceLattice space_lattice(const Box& box, std::size_t nodes) {
  const Vector3 extent = box.sizes();
  // A flat box gets cells as high as wide at the least.
  const double least = extent.maxCoeff() / static_cast<double>(nodes);
  const double volume = extent.cwiseMax(least).prod();
  SpaceLattice result;
  result.lattice = {box.min(), std::cbrt(volume / static_cast<double>(nodes))};
  for (int axis = 0; axis < 3; ++axis)
    result.size[static_cast<std::size_t>(axis)] =
        std::max(2, static_cast<int>(std::ceil(extent[axis] / result.lattice.voxel_size)) + 1);
  return result;
}

std::vector<double> determinants(const ElasticMap& elastic, const Points& x) {
  const Points gradients = elastic.displacement_gradient(x);
  const Matrix3 linear = elastic.affine().linear;
  std::vector<double> values;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    values.push_back((linear + gradients.middleCols<3>(3 * i)).determinant());
  return values;
}

}  // namespace bespoke
