#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace bespoke {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

/// 3×n, one column per point, mesh units.
using Points = Eigen::Matrix3Xd;

/// 3×m, one column per triangle: three vertex indices, counter-clockwise seen from outside.
using Faces = Eigen::Matrix3Xi;

/// Axis-aligned box, mesh units.
using Box = Eigen::AlignedBox3d;

/// x ↦ offset + linear · x; the part a₀ + A x of the elastic map (src/bespoke/README.md, "The mapping").
struct AffineMap {
  Matrix3 linear = Matrix3::Identity();
  Vector3 offset = Vector3::Zero();  ///< mesh units

  Vector3 operator*(const Vector3& x) const { return offset + linear * x; }
  Points operator*(const Points& x) const { return (linear * x).colwise() + offset; }
};

}  // namespace bespoke
