#include "bespoke/product/carry/directions.h"

namespace bespoke {
namespace {

/// `moved` as long as `direction`; `direction` itself where either has no direction.
Vector3 with_length_of(const Vector3& direction, const Vector3& moved) {
  if (moved == direction) return direction;  // its zeros keep their signs
  const double length = direction.norm();
  const double moved_length = moved.norm();
  if (!(length > 0 && moved_length > 0 && std::isfinite(length / moved_length))) return direction;
  return moved * (length / moved_length);
}

}  // namespace

Points moved_normals(const Points& normals, const Points& jacobians) {
  Points moved(3, normals.cols());
  for (Eigen::Index i = 0; i < normals.cols(); ++i) {
    const Matrix3 jacobian = jacobians.middleCols<3>(3 * i);
    Matrix3 cofactors;
    for (int axis = 0; axis < 3; ++axis)
      cofactors.col(axis) = jacobian.col((axis + 1) % 3).cross(jacobian.col((axis + 2) % 3));
    moved.col(i) = with_length_of(normals.col(i), cofactors * normals.col(i));
  }
  return moved;
}

Vector3 middle_direction(const Vector3& a, const Vector3& b) {
  const Vector3 mean = 0.5 * (a + b);
  const double length = mean.norm();
  return length > 0 ? Vector3(mean * (0.5 * (a.norm() + b.norm()) / length)) : a;
}

Points moved_tangents(const Points& tangents, const Points& jacobians) {
  Points moved(3, tangents.cols());
  for (Eigen::Index i = 0; i < tangents.cols(); ++i)
    moved.col(i) = with_length_of(tangents.col(i), jacobians.middleCols<3>(3 * i) * tangents.col(i));
  return moved;
}

}  // namespace bespoke
