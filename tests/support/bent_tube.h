#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke::shapes {

inline constexpr double elbow = 2;     ///< where tube() bends
inline constexpr int tube_sides = 12;  ///< vertices of a ring

/// A tube of radius 0.2 along x from 0 to 4, open at both ends.
inline TriangleMesh tube() {
  constexpr int along = 80;
  TriangleMesh mesh;
  mesh.vertices.resize(3, tube_sides * (along + 1));
  mesh.faces.resize(3, 2 * tube_sides * along);
  for (int ring = 0; ring <= along; ++ring)
    for (int k = 0; k < tube_sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / tube_sides;
      mesh.vertices.col(ring * tube_sides + k) << 4.0 * ring / along, 0.2 * std::cos(angle),
          0.2 * std::sin(angle);
    }
  for (int ring = 0; ring < along; ++ring)
    for (int k = 0; k < tube_sides; ++k) {
      const int a = ring * tube_sides + k, b = ring * tube_sides + (k + 1) % tube_sides;
      mesh.faces.col(2 * (ring * tube_sides + k)) << a, b, a + tube_sides;
      mesh.faces.col(2 * (ring * tube_sides + k) + 1) << b, b + tube_sides, a + tube_sides;
    }
  return mesh;
}

/// What lies beyond the elbow turns about it.
inline Vector3 bent(const Vector3& x, double degrees) {
  if (x[0] <= elbow) return x;
  const Vector3 joint(elbow, 0, 0);
  return joint + Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vector3::UnitZ()) * Vector3(x - joint);
}

/// The numbers of eight vertices of tube(): opposite ones at both ends and either side of the elbow.
inline std::vector<int> tube_marks() {
  std::vector<int> marks;
  for (const int ring : {0, 25, 55, 80})
    for (const int side : {0, tube_sides / 2}) marks.push_back(ring * tube_sides + side);
  return marks;
}

}  // namespace bespoke::shapes
