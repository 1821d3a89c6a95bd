#pragma once

#include <cmath>
#include <numbers>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/pattern/garment.h"

namespace bespoke::test {

/// A tube about y of `sides` planar sides, open at both ends; radius and height in millimetres. Its first
/// `sides` vertices are the lower loop.
inline TriangleMesh tube(int sides, int rows, double radius, double height) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, sides * rows);
  mesh.faces.resize(3, 2 * sides * (rows - 1));
  Eigen::Index face = 0;
  for (int r = 0; r < rows; ++r)
    for (int s = 0; s < sides; ++s) {
      const double angle = 2 * std::numbers::pi * s / sides;
      mesh.vertices.col(r * sides + s) << radius * std::sin(angle), height * r / (rows - 1),
          radius * std::cos(angle);
      if (r + 1 == rows) continue;
      const int a = r * sides + s, b = r * sides + (s + 1) % sides;
      mesh.faces.col(face++) << a, b, a + sides;
      mesh.faces.col(face++) << b, b + sides, a + sides;
    }
  return mesh;
}

/// As read_garment would make it of a file without groups.
inline Garment garment_of(TriangleMesh mesh) {
  Garment garment;
  garment.path = "garment.obj";
  garment.group_of_face.assign(static_cast<std::size_t>(mesh.faces.cols()), 0);
  garment.mesh = std::move(mesh);
  return garment;
}

/// Length of the side of a regular polygon.
inline double side_of(int sides, double radius) { return 2 * radius * std::sin(std::numbers::pi / sides); }

}  // namespace bespoke::test
