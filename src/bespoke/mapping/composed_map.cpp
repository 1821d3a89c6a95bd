#include "bespoke/mapping/composed_map.h"

#include <Eigen/SVD>

#include "bespoke/mapping/affine_map.h"

namespace bespoke {

ComposedMap::ComposedMap(const ElasticMap& b_from_a, const RigidTransform& rigid_b_from_a,
                         const ElasticMap& c_from_b)
    : b_from_a_(b_from_a), rigid_b_from_a_(rigid_b_from_a), c_from_b_(c_from_b) {}

AffineMap ComposedMap::affine() const {
  const AffineMap rigid = as_affine(rigid_b_from_a_);
  return compose(as_affine(inverse(rigid_b_from_a_)),
                 compose(c_from_b_.affine(), compose(rigid, b_from_a_.affine())));
}

Points ComposedMap::displacement(const Points& x) const {
  const Points first = b_from_a_.displacement(x);
  const Points in_b = rigid_b_from_a_ * Points(b_from_a_.affine() * x + first);
  const Matrix3& rotation = rigid_b_from_a_.rotation;
  return rotation.transpose() *
         (c_from_b_.affine().linear * (rotation * first) + c_from_b_.displacement(in_b));
}

Points ComposedMap::displacement_gradient(const Points& x) const {
  Points gradient = b_from_a_.displacement_gradient(x);
  const Points in_b = rigid_b_from_a_ * b_from_a_(x);
  const Points second = c_from_b_.displacement_gradient(in_b);
  const Matrix3& rotation = rigid_b_from_a_.rotation;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Matrix3 inner = gradient.middleCols<3>(3 * i);
    const Matrix3 outer = second.middleCols<3>(3 * i);
    gradient.middleCols<3>(3 * i) =
        rotation.transpose() * (c_from_b_.affine().linear * rotation * inner +
                                outer * rotation * (b_from_a_.affine().linear + inner));
  }
  return gradient;
}

// Outside the first support the first map is affine, so the second one's support is seen through that.
Support ComposedMap::support() const {
  Support support;
  const auto add = [&](const Support& part, const AffineMap& frame) {
    const AffineMap back = inverse(compose(part.frame, frame));
    const double stretch = Eigen::JacobiSVD<Matrix3>(back.linear).singularValues()[0];
    for (const BallCloud& cloud : part.clouds)
      support.clouds.push_back({back * cloud.centers, stretch * cloud.radius});
  };
  add(b_from_a_.support(), {});
  add(c_from_b_.support(), compose(as_affine(rigid_b_from_a_), b_from_a_.affine()));
  return support;
}

}  // namespace bespoke
