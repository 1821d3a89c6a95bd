#pragma once

#include <cmath>
#include <numbers>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke::shapes {

constexpr double pocket_rim = 20 * std::numbers::pi / 180;  // polar angle of the pocket's mouth
constexpr double pocket_radius = 0.4;

/// Where the pocket's sphere has its centre, on the axis.
inline double pocket_center(double rim = pocket_rim) {
  return std::cos(rim) - std::sqrt(pocket_radius * pocket_radius - std::sin(rim) * std::sin(rim));
}

/// A point of the outline, radius and height, from the south pole over the rim into the pocket, s in [0, 1].
inline Eigen::Vector2d pocketed_outline(double s, double rim) {
  const double pi = std::numbers::pi;
  if (s < 0.5) {
    const double polar = pi - (pi - rim) * s / 0.5;
    return {std::sin(polar), std::cos(polar)};
  }
  const double mouth = std::asin(std::sin(rim) / pocket_radius);
  const double polar = mouth + (pi - mouth) * (s - 0.5) / 0.5;
  return {pocket_radius * std::sin(polar), pocket_center(rim) + pocket_radius * std::cos(polar)};
}

/// The unit sphere with a pocket behind a narrow mouth at its north pole, closed.
inline TriangleMesh pocketed_ball(double rim = pocket_rim) {
  constexpr int rings = 60, segments = 48;
  TriangleMesh mesh{Points(3, (rings - 1) * segments + 2), Faces(3, 2 * segments * (rings - 1))};
  const auto vertex = [](int ring, int segment) {
    if (ring == 0) return 0;
    if (ring == rings) return (rings - 1) * segments + 1;
    return 1 + (ring - 1) * segments + segment % segments;
  };
  Eigen::Index face = 0;
  for (int ring = 0; ring <= rings; ++ring)
    for (int segment = 0; segment < segments; ++segment) {
      const Eigen::Vector2d at = pocketed_outline(double(ring) / rings, rim);
      const double angle = 2 * std::numbers::pi * segment / segments;
      mesh.vertices.col(vertex(ring, segment)) =
          Vector3(at[0] * std::cos(angle), at[0] * std::sin(angle), at[1]);
      if (ring == rings) continue;
      const int a = vertex(ring, segment), b = vertex(ring, segment + 1);
      const int c = vertex(ring + 1, segment), d = vertex(ring + 1, segment + 1);
      if (a != b) mesh.faces.col(face++) << a, b, d;
      if (c != d) mesh.faces.col(face++) << a, d, c;
    }
  return mesh;
}

/// Of the pocketed ball's vertices.
inline bool in_pocket(const Vector3& x) { return x.norm() < 0.9; }

}  // namespace bespoke::shapes
