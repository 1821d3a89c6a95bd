#include "bespoke/rigid/rigid_transform.h"

#include <cmath>
#include <string>

#include "bespoke/error.h"

namespace bespoke {
namespace {

/// Angles with rotation = Rz(z) · Ry(y) · Rx(x), radians.
struct EulerAngles {
  double x = 0;
  double y = 0;
  double z = 0;
};

EulerAngles euler_angles(const Matrix3& rotation) {
  const double cosine_y = std::hypot(rotation(0, 0), rotation(1, 0));
  const double y = std::atan2(-rotation(2, 0), cosine_y);
  // Gimbal lock: only x ∓ z is determined; below this cosine the two arcs tangent of the regular case are
  // made of rounding errors.
  constexpr double smallest_cosine = 1e-12;
  if (cosine_y < smallest_cosine) return {std::atan2(-rotation(1, 2), rotation(1, 1)), y, 0};
  return {std::atan2(rotation(2, 1), rotation(2, 2)), y, std::atan2(rotation(1, 0), rotation(0, 0))};
}

}  // namespace

RigidTransform inverse(const RigidTransform& transform) {
  const Matrix3 transposed = transform.rotation.transpose();
  return {transposed, -(transposed * transform.translation)};
}

double rotation_angle(const RigidTransform& transform) {
  return Eigen::AngleAxisd(transform.rotation).angle();
}

Matrix3 rotation_at(const Matrix3& rotation, RotationPath path, double t) {
  if (!std::isfinite(t)) throw InvalidInput("rotation at t = " + std::to_string(t) + ": t must be finite");
  if (t == 0) return Matrix3::Identity();
  if (t == 1) return rotation;
  if (path == RotationPath::euler) {
    const EulerAngles angles = euler_angles(rotation);
    return (Eigen::AngleAxisd(t * angles.z, Vector3::UnitZ()) *
            Eigen::AngleAxisd(t * angles.y, Vector3::UnitY()) *
            Eigen::AngleAxisd(t * angles.x, Vector3::UnitX()))
        .toRotationMatrix();
  }
  // Through the quaternion: unlike the trace and the skew part it keeps all digits of the axis near half a
  // turn.
  const Eigen::Quaterniond quaternion(rotation);
  const double sine = quaternion.vec().norm();
  if (!(sine > 0)) return Matrix3::Identity();
  // |w| and the sign on the axis: the shorter of the two ways round.
  const double angle = 2 * std::atan2(sine, std::abs(quaternion.w()));
  const Vector3 axis = quaternion.vec() * ((quaternion.w() < 0 ? -1 : 1) / sine);
  return Eigen::AngleAxisd(t * angle, axis).toRotationMatrix();
}

}  // namespace bespoke
