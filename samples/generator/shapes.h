#pragma once

#include <Eigen/Core>
#include <array>
#include <numbers>
#include <variant>
#include <vector>

namespace bespoke {

inline constexpr double degree = std::numbers::pi / 180;

/// Shapes of which the samples are moulded, in centimetres and in coordinates of their own. `distance` is
/// negative inside, zero on the surface, and near the surface close to the signed distance.

struct Sphere {
  Eigen::Vector3d centre;
  double radius;
};

/// Two spheres and the cone that touches both. Neither sphere may contain the other.
struct RoundCone {
  Sphere from;
  Sphere to;
};

struct Ellipsoid {
  Eigen::Vector3d centre;
  Eigen::Vector3d radii;
};

/// One cross-section of a loft at height y: an oval about (x, z) with one half-width and two depths.
struct Section {
  double y;
  double x;
  double z;
  double half_width;
  double front;
  double back;
};

/// A body along the y axis whose ovals run smoothly (monotone cubic) through the given sections, at least two
/// of them, y ascending. Both ends are closed by caps of the given heights.
struct Loft {
  Loft(std::vector<Section> sections, double bottom_cap, double top_cap, double exponent = 2.0);

  Section at(double y) const;

  std::vector<Section> sections;
  double bottom_cap;
  double top_cap;
  double exponent;  ///< 2: ellipse; larger: squarer

 private:
  std::vector<std::array<double, 5>> slopes_;
};

using Shape = std::variant<Sphere, RoundCone, Ellipsoid, Loft>;

double distance(const Shape& shape, const Eigen::Vector3d& point);

/// A sphere that contains the shape.
Sphere bounding_sphere(const Shape& shape);

}  // namespace bespoke
