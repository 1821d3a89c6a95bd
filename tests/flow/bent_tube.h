#pragma once

#include <cmath>
#include <numbers>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke::test {

inline constexpr double tube_length = 10;
inline constexpr double tube_radius = 0.5;
inline constexpr double joint_begin = 4;
inline constexpr double joint_end = 6;

/// An open tube along x, 0 … tube_length.
inline TriangleMesh tube(int rings = 41, int sides = 16) {
  TriangleMesh mesh{Points(3, rings * sides), Faces(3, 2 * (rings - 1) * sides)};
  Eigen::Index face = 0;
  for (int ring = 0; ring < rings; ++ring)
    for (int side = 0; side < sides; ++side) {
      const double angle = 2 * std::numbers::pi * side / sides;
      mesh.vertices.col(ring * sides + side) << tube_length * ring / (rings - 1),
          tube_radius * std::cos(angle), tube_radius * std::sin(angle);
      if (ring + 1 == rings) continue;
      const int a = ring * sides + side, b = ring * sides + (side + 1) % sides;
      mesh.faces.col(face++) << a, b, a + sides;
      mesh.faces.col(face++) << b, b + sides, a + sides;
    }
  return mesh;
}

/// The tube's points with all beyond the joint turned by `angle` (radians) about z; the joint is an arc.
inline Points bent(const Points& x, double angle) {
  Points result = x;
  const double radius = (joint_end - joint_begin) / angle;
  for (auto point : result.colwise()) {
    const double along = std::clamp(point.x(), joint_begin, joint_end) - joint_begin;
    const double beyond = point.x() - joint_begin - along;
    const double turned = along / radius;
    const Vector3 forward(std::cos(turned), std::sin(turned), 0),
        left(-std::sin(turned), std::cos(turned), 0);
    const Vector3 arc(joint_begin + radius * std::sin(turned), radius * (1 - std::cos(turned)), 0);
    point = arc + beyond * forward + point.y() * left + Vector3(0, 0, point.z());
  }
  return result;
}

/// The tube's points with all beyond the joint turned by `angle` (radians) about x.
inline Points twisted(const Points& x, double angle) {
  Points result = x;
  for (auto point : result.colwise()) {
    const double along =
        (std::clamp(point.x(), joint_begin, joint_end) - joint_begin) / (joint_end - joint_begin);
    point = Eigen::AngleAxisd(along * angle, Vector3::UnitX()) * Vector3(point);
  }
  return result;
}

}  // namespace bespoke::test
