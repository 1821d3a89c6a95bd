#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "bespoke/clearance/obstacle.h"
#include "support/shapes.h"

namespace bespoke::test {

/// The sphere of radius 1 around the origin as obstacle in closed form, on source and target alike.
inline Obstacle unit_ball(ClearanceRule rule = {}) {
  const auto distance = [](const Points& x) {
    std::vector<double> values;
    for (const auto& point : x.colwise()) values.push_back(point.norm() - 1);
    return values;
  };
  Obstacle ball;
  ball.name = "the ball";
  ball.distance = distance;
  ball.required = [=](const SourcePlaces& places) {
    std::vector<double> values = distance(places.points());
    for (double& value : values)
      if (rule.ease) value = *rule.ease;
    return values;
  };
  ball.step = 1e-3;
  ball.tolerance = clearance_tolerance * 2;
  return ball;
}

/// A sphere around the origin.
inline TriangleMesh shell(double radius, int levels = 4) {
  TriangleMesh mesh = shapes::icosphere(levels);
  mesh.vertices *= radius;
  return mesh;
}

/// The vertices with those that point within `angle` (radians) of +z pushed towards the origin, by `depth`
/// in the middle and by nothing at the rim.
inline Points dented(Points vertices, double angle, double depth) {
  for (auto point : vertices.colwise()) {
    const double at = std::acos(std::clamp(point.normalized().z(), -1.0, 1.0)) / angle;
    if (at < 1) point -= depth * (1 - at * at) * point.normalized();
  }
  return vertices;
}

/// n flags: within `angle` of +z.
inline std::vector<char> near_pole(const Points& vertices, double angle) {
  std::vector<char> flags;
  for (const auto& point : vertices.colwise())
    flags.push_back(std::acos(std::clamp(point.normalized().z(), -1.0, 1.0)) < angle);
  return flags;
}

}  // namespace bespoke::test
