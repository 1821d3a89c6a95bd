#include "bespoke/surface_fit/detail/cavities.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr double rim = 20 * std::numbers::pi / 180;  // polar angle of the pocket's mouth
constexpr double pocket_radius = 0.4;
constexpr int rings = 60, segments = 48;

/// Where the pocket's sphere has its centre, on the axis.
double pocket_centre() {
  return std::cos(rim) - std::sqrt(pocket_radius * pocket_radius - std::sin(rim) * std::sin(rim));
}

/// A point of the outline, radius and height, from the south pole over the rim into the pocket, s in [0, 1].
Eigen::Vector2d outline(double s) {
  const double pi = std::numbers::pi;
  if (s < 0.5) {
    const double polar = pi - (pi - rim) * s / 0.5;
    return {std::sin(polar), std::cos(polar)};
  }
  const double mouth = std::asin(std::sin(rim) / pocket_radius);
  const double polar = mouth + (pi - mouth) * (s - 0.5) / 0.5;
  return {pocket_radius * std::sin(polar), pocket_centre() + pocket_radius * std::cos(polar)};
}

/// The unit sphere with a pocket behind a narrow mouth at its north pole.
TriangleMesh sphere_with_pocket() {
  TriangleMesh mesh{Points(3, (rings - 1) * segments + 2), Faces(3, 2 * segments * (rings - 1))};
  const auto vertex = [](int ring, int segment) {
    if (ring == 0) return 0;
    if (ring == rings) return (rings - 1) * segments + 1;
    return 1 + (ring - 1) * segments + segment % segments;
  };
  Eigen::Index face = 0;
  for (int ring = 0; ring <= rings; ++ring)
    for (int segment = 0; segment < segments; ++segment) {
      const Eigen::Vector2d at = outline(double(ring) / rings);
      const double angle = 2 * std::numbers::pi * segment / segments;
      mesh.vertices.col(vertex(ring, segment)) =
          Vector3(at[0] * std::cos(angle), at[0] * std::sin(angle), at[1]);
      if (ring == rings) continue;
      const int a = vertex(ring, segment), b = vertex(ring, segment + 1);
      const int c = vertex(ring + 1, segment), d = vertex(ring + 1, segment + 1);
      if (a != b) mesh.faces.col(face++) << a, b, d;
      if (c != d) mesh.faces.col(face++) << a, d, c;
    }
  EXPECT_EQ(face, mesh.faces.cols());
  return mesh;
}

bool in_pocket(const Vector3& x) { return x.norm() < 0.9; }

/// Degrees between the way from x through the pocket's centre and the rim of its mouth, positive where that
/// way leads out.
double way_out(const Vector3& x) {
  const double mouth = std::asin(std::sin(rim) / pocket_radius);
  const Vector3 way = (Vector3(0, 0, pocket_centre()) - x).normalized();
  return (mouth - std::acos(std::clamp(way.z(), -1.0, 1.0))) * 180 / std::numbers::pi;
}

bool near_rim(const Vector3& x) {
  return (x.normalized() - Vector3::UnitZ()).norm() < 2 * rim && x.z() > 0.8;
}

constexpr CavitySettings far_reach{.reach = 0.3};

std::vector<char> found(const TriangleMesh& source, const TriangleMesh& target) {
  return vertices_in_lacking_cavities(TargetSurface(source), TargetSurface(target), diagonal(source.vertices),
                                      far_reach);
}

TEST(Cavities, AreFoundWhereTheTargetIsSmooth) {
  const TriangleMesh source = sphere_with_pocket();
  const std::vector<char> hidden = found(source, shapes::icosphere(5));
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    const Vector3 x = source.vertices.col(static_cast<Eigen::Index>(i));
    // The bottom of the pocket sees out of it.
    constexpr double border = 6;
    if (!near_rim(x) && !(in_pocket(x) && std::abs(way_out(x)) < border)) {
      EXPECT_EQ(hidden[i] != 0, in_pocket(x) && way_out(x) < 0) << x.transpose();
    }
  }
}

TEST(Cavities, AreLackingNowhereWhereTheTargetHasThemToo) {
  const std::vector<char> hidden = found(sphere_with_pocket(), sphere_with_pocket());
  EXPECT_EQ(std::count(hidden.begin(), hidden.end(), 1), 0);
}

TEST(Cavities, AreTheSameInAnyPlaceAndSize) {
  const TriangleMesh source = sphere_with_pocket(), target = shapes::icosphere(5);
  const Eigen::AngleAxisd turn(1.1, Vector3(1, 2, -1).normalized());
  const auto moved = [&](TriangleMesh mesh) {
    mesh.vertices = ((7.5 * turn.toRotationMatrix() * mesh.vertices).colwise() + Vector3(3, -20, 8)).eval();
    return mesh;
  };
  const std::vector<char> there = vertices_in_lacking_cavities(
      TargetSurface(moved(source)), TargetSurface(moved(target)), 7.5 * diagonal(source.vertices), far_reach);
  const std::vector<char> here = found(source, target);
  std::size_t differing = 0;
  for (std::size_t i = 0; i < here.size(); ++i) differing += here[i] != there[i];
  EXPECT_LE(differing, here.size() / 100);  // ties of closest points
}

}  // namespace
}  // namespace bespoke
