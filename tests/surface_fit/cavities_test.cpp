#include "bespoke/surface_fit/matching/cavities.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/pocketed_ball.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

/// Degrees between the way from x through the pocket's centre and the rim of its mouth, positive where that
/// way leads out.
double way_out(const Vector3& x) {
  const double mouth = std::asin(std::sin(shapes::pocket_rim) / shapes::pocket_radius);
  const Vector3 way = (Vector3(0, 0, shapes::pocket_center()) - x).normalized();
  return (mouth - std::acos(std::clamp(way.z(), -1.0, 1.0))) * 180 / std::numbers::pi;
}

bool near_rim(const Vector3& x) {
  return (x.normalized() - Vector3::UnitZ()).norm() < 2 * shapes::pocket_rim && x.z() > 0.8;
}

constexpr CavitySettings far_reach{.reach = 1};  // of balls of radius 1

std::vector<char> found(const TriangleMesh& source, const TriangleMesh& target) {
  return vertices_in_unmatched_cavities(TargetSurface(source), TargetSurface(target), far_reach);
}

TEST(Cavities, AreFoundWhereTheTargetIsSmooth) {
  const TriangleMesh source = shapes::pocketed_ball();
  const std::vector<char> hidden = found(source, shapes::icosphere(5));
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    const Vector3 x = source.vertices.col(static_cast<Eigen::Index>(i));
    // The bottom of the pocket sees out of it.
    constexpr double border = 6;
    if (!near_rim(x) && !(shapes::in_pocket(x) && std::abs(way_out(x)) < border)) {
      EXPECT_EQ(hidden[i] != 0, shapes::in_pocket(x) && way_out(x) < 0) << x.transpose();
    }
  }
}

TEST(Cavities, AreLackingNowhereWhereTheTargetHasThemToo) {
  const std::vector<char> hidden = found(shapes::pocketed_ball(), shapes::pocketed_ball());
  EXPECT_EQ(std::count(hidden.begin(), hidden.end(), 1), 0);
}

TEST(Cavities, AreTheSameInAnyPlace) {
  const TriangleMesh source = shapes::pocketed_ball(), target = shapes::icosphere(5);
  const Eigen::AngleAxisd turn(1.1, Vector3(1, 2, -1).normalized());
  const auto moved = [&](TriangleMesh mesh) {
    mesh.vertices = ((turn.toRotationMatrix() * mesh.vertices).colwise() + Vector3(3, -20, 8)).eval();
    return mesh;
  };
  const std::vector<char> there = found(moved(source), moved(target));
  const std::vector<char> here = found(source, target);
  std::size_t differing = 0;
  for (std::size_t i = 0; i < here.size(); ++i) differing += here[i] != there[i];
  EXPECT_LE(differing, here.size() / 100);  // ties of closest points
}

}  // namespace
}  // namespace bespoke
