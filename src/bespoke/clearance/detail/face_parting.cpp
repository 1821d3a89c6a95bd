#include "bespoke/clearance/detail/face_parting.h"

#include <Eigen/Geometry>

namespace bespoke {
namespace {

// Of the product of the edges' lengths: shorter, a cross product has no direction.
constexpr double min_sine = 1e-3;

// Of the largest coordinates along the axis: nearer, rounding decides whether they are apart.
constexpr double min_gap = 1e-9;

Vector3 edge(const Matrix3& face, int k) { return face.col((k + 1) % 3) - face.col(k); }

/// Unit, or zero where it has no direction.
Vector3 across(const Vector3& a, const Vector3& b) {
  const Vector3 axis = a.cross(b);
  const double length = axis.norm();
  return length > min_sine * a.norm() * b.norm() ? Vector3(axis / length) : Vector3(Vector3::Zero());
}

/// Axis number `i` of the two faces: their normals, then edge by edge, then in their planes across edges.
Vector3 axis_of(const Matrix3& first, const Matrix3& second, int i) {
  if (i == 0) return across(edge(first, 0), edge(first, 1));
  if (i == 1) return across(edge(second, 0), edge(second, 1));
  if (i < 11) return across(edge(first, (i - 2) / 3), edge(second, (i - 2) % 3));
  const Matrix3& face = i < 14 ? first : second;
  return across(across(edge(face, 0), edge(face, 1)), edge(face, (i - 11) % 3));
}

constexpr int axes = 17;

/// From the first face's end to the second's beginning along the axis.
double gap(const Matrix3& first, const Matrix3& second, const Vector3& axis) {
  return (axis.transpose() * second).minCoeff() - (axis.transpose() * first).maxCoeff();
}

}  // namespace

std::optional<Parting> parting(const Matrix3& first_before, const Matrix3& second_before,
                               const Matrix3& first_now, const Matrix3& second_now) {
  std::optional<Parting> least;
  for (int i = 0; i < axes; ++i) {
    const Vector3 before = axis_of(first_before, second_before, i);
    const Vector3 now = axis_of(first_now, second_now, i);
    if (before.isZero(0) || now.isZero(0)) continue;
    for (const double sign : {1.0, -1.0}) {
      const double largest = (before.transpose() * first_before).cwiseAbs().maxCoeff() +
                             (before.transpose() * second_before).cwiseAbs().maxCoeff();
      if (!(gap(first_before, second_before, sign * before) > min_gap * largest)) continue;
      const double overlap = -gap(first_now, second_now, sign * now);
      if (!least || overlap < least->overlap) least = {sign * now, overlap};
    }
  }
  return least;
}

}  // namespace bespoke
