#pragma once

#include <array>

#include "bespoke/enum_names.h"
#include "bespoke/types.h"

namespace bespoke {

/// x ↦ R x + T, the paper's Γ. Named by direction: `target_from_source * x_in_source`.
struct RigidTransform {
  Matrix3 rotation = Matrix3::Identity();  ///< orthonormal, det +1
  Vector3 translation = Vector3::Zero();   ///< mesh units

  Vector3 operator*(const Vector3& x) const { return rotation * x + translation; }
  Points operator*(const Points& x) const { return (rotation * x).colwise() + translation; }
  RigidTransform operator*(const RigidTransform& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }
};

/// Γ⁻¹: y ↦ Rᵀ (y − T). (The paper writes R(−θ), which with Euler angles is not the inverse.)
RigidTransform inverse(const RigidTransform& transform);

/// Of the rotation about its one axis, radians, 0 … π.
double rotation_angle(const RigidTransform& transform);

/// How the rotation grows from the identity at t = 0 to R at t = 1.
enum class RotationPath {
  geodesic,  ///< exp(t log R): constant angular speed about one axis
  euler,     ///< Eq. 1 as printed: the three Euler angles of R = Rz Ry Rx, each times t
  flow,      ///< geodesic, while the elastic part goes through the steps of a chain (ElasticChain::at)
};

inline constexpr std::array rotation_paths{Named<RotationPath>{"geodesic", RotationPath::geodesic},
                                           Named<RotationPath>{"euler", RotationPath::euler},
                                           Named<RotationPath>{"flow", RotationPath::flow}};

/// R(t). At t = 0 the identity, at t = 1 `rotation`, exactly.
Matrix3 rotation_at(const Matrix3& rotation, RotationPath path, double t);

}  // namespace bespoke
