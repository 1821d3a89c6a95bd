#include "bespoke/mapping/affine_map.h"

#include <Eigen/LU>
#include <cmath>

#include "bespoke/error.h"
#include "bespoke/length.h"

namespace bespoke {

AffineMap compose(const AffineMap& outer, const AffineMap& inner) {
  return {outer.linear * inner.linear, outer.linear * inner.offset + outer.offset};
}

AffineMap inverse(const AffineMap& map) {
  const Matrix3 linear = map.linear.inverse();
  if (!(linear.allFinite() && map.offset.allFinite()))
    throw InvalidInput("the affine part of the map is singular: it has no inverse");
  return {linear, -(linear * map.offset)};
}

double size_ratio(const AffineMap& map) { return std::cbrt(std::abs(map.linear.determinant())); }

double power_of_two_scale(const AffineMap& map) { return power_of_two_scale(size_ratio(map)); }

AffineMap as_affine(const RigidTransform& transform) { return {transform.rotation, transform.translation}; }

}  // namespace bespoke
