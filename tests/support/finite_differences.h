#pragma once

#include "bespoke/types.h"

namespace bespoke::test {

/// 3×3n: central differences of `map.displacement` at the columns of x, laid out as its gradient is.
template <class Map>
Points finite_differences(const Map& map, const Points& x, double step) {
  Points gradient(3, 3 * x.cols());
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 offset = step * Vector3::Unit(axis);
    const Points slope =
        (map.displacement(x.colwise() + offset) - map.displacement(x.colwise() - offset)) / (2 * step);
    for (Eigen::Index i = 0; i < x.cols(); ++i) gradient.col(3 * i + axis) = slope.col(i);
  }
  return gradient;
}

}  // namespace bespoke::test
