#pragma once

#include "bespoke/rigid/rigid_transform.h"

namespace bespoke::test {

inline RigidTransform some_motion() {
  return {Eigen::AngleAxisd(0.7, Vector3(1, 1, 0).normalized()).toRotationMatrix(), {1, -2, 3}};
}

/// z grows with the square of x, so that straight edges along x bend.
inline Points bend(const Points& x) {
  Points y = x;
  y.row(2) += 0.5 * x.row(0).cwiseAbs2();
  return y;
}

}  // namespace bespoke::test
