#pragma once

#include <gmock/gmock.h>

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/rigid/rigid_transform.h"
#include "support/analytic_map.h"
#include "support/finite_differences.h"

namespace bespoke::test {

inline AffineMap some_affine() {
  AffineMap affine;
  affine.linear << 1.1, 0.1, 0, -0.1, 0.9, 0.05, 0, 0.02, 1.05;
  affine.offset << 0.1, 0.2, -0.3;
  return affine;
}

inline RigidTransform some_rigid() {
  RigidTransform rigid;
  rigid.rotation = Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  rigid.translation << 3, -1, 2;
  return rigid;
}

// Strong but orientation-preserving.
inline AnalyticMap strong_bumps(double scale = 1) {
  return AnalyticMap({{Vector3(0, 0, 0), 1.0, scale * Vector3(0.35, 0.1, -0.05)},
                      {Vector3(0.9, 0.5, 0), 0.7, scale * Vector3(-0.05, -0.15, 0.1)},
                      {Vector3(-0.2, 0.4, 0.1), 0.2, scale * Vector3(0, 0.05, 0.02)}},
                     some_affine());
}

// Outside its support u is zero, bit for bit; inside somewhere it is not.
inline void expect_support_holds(const ElasticMap& map, const Points& x) {
  const Support support = map.support();
  const Points u = map.displacement(x);
  int outside = 0, moved = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    bool inside = false;
    const Vector3 seen = support.frame * Vector3(x.col(i));
    for (const BallCloud& cloud : support.clouds)
      inside = inside || ((cloud.centers.colwise() - seen).colwise().norm().array() <= cloud.radius).any();
    outside += !inside;
    moved += !u.col(i).isZero(0);
    if (!inside) {
      ASSERT_EQ(Vector3(u.col(i)), Vector3::Zero());
    }
  }
  EXPECT_GT(outside, 100);
  EXPECT_GT(moved, 100);
}

inline Points near_and_far() {
  Points x(3, 10000);
  x << Points::Random(3, 5000), 12 * Points::Random(3, 5000);
  return x;
}

inline void expect_gradient_is_the_limit_of_differences(const ElasticMap& map, const Points& x) {
  const Points gradient = map.displacement_gradient(x);
  const Points difference = finite_differences(map, x, 1e-4);
  const auto close = ((difference - gradient).colwise().norm().array() < 1e-3).count();
  // A few differences straddle cells, where the gradient jumps.
  EXPECT_GT(close, gradient.cols() * 9 / 10);
}

}  // namespace bespoke::test
