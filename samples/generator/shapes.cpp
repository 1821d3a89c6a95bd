#include "shapes.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace bespoke {
namespace {

constexpr int section_values = 5;

std::array<double, section_values> values_of(const Section& section) {
  return {section.x, section.z, section.half_width, section.front, section.back};
}

// Fritsch and Carlson's harmonic mean: the curve never overshoots its keys.
double monotone_slope(double left_width, double left_slope, double right_width, double right_slope) {
  if (left_slope * right_slope <= 0.0) return 0.0;
  const double left_weight = 2.0 * right_width + left_width;
  const double right_weight = right_width + 2.0 * left_width;
  return (left_weight + right_weight) / (left_weight / left_slope + right_weight / right_slope);
}

double distance_to(const Sphere& sphere, const Eigen::Vector3d& point) {
  return (point - sphere.centre).norm() - sphere.radius;
}

double distance_to(const RoundCone& cone, const Eigen::Vector3d& point) {
  const Eigen::Vector3d axis = cone.to.centre - cone.from.centre;
  const double length = axis.norm();
  const Eigen::Vector3d offset = point - cone.from.centre;
  const double along = offset.dot(axis) / length;
  const double across = std::sqrt(std::max(0.0, offset.squaredNorm() - along * along));
  const double sine = (cone.from.radius - cone.to.radius) / length;
  const double cosine = std::sqrt(1.0 - sine * sine);
  const double foot = along * cosine - across * sine;
  if (foot < 0.0) return std::hypot(along, across) - cone.from.radius;
  if (foot > length * cosine) return std::hypot(along - length, across) - cone.to.radius;
  return along * sine + across * cosine - cone.from.radius;
}

double distance_to(const Ellipsoid& ellipsoid, const Eigen::Vector3d& point) {
  const Eigen::Vector3d scaled = (point - ellipsoid.centre).cwiseQuotient(ellipsoid.radii);
  const double level = scaled.norm();
  const double slope = scaled.cwiseQuotient(ellipsoid.radii).norm();
  if (!(slope > 1e-12)) return -ellipsoid.radii.minCoeff();
  return level * (level - 1.0) / slope;
}

double distance_to(const Loft& loft, const Eigen::Vector3d& point) {
  const double bottom = loft.sections.front().y;
  const double top = loft.sections.back().y;
  const double y = std::clamp(point.y(), bottom, top);
  const Section section = loft.at(y);
  const double x = std::abs(point.x() - section.x);
  const double z = point.z() - section.z;
  const double beyond = point.y() - y;
  const double scaled_x = x / section.half_width;
  const double scaled_z = std::abs(z) / (z > 0.0 ? section.front : section.back);
  const double level_across =
      loft.exponent == 2.0 ? std::hypot(scaled_x, scaled_z)
                           : std::pow(std::pow(scaled_x, loft.exponent) + std::pow(scaled_z, loft.exponent),
                                      1.0 / loft.exponent);
  const double level = std::hypot(level_across, beyond / (beyond < 0.0 ? loft.bottom_cap : loft.top_cap));
  const double reach = std::sqrt(x * x + z * z + beyond * beyond);
  if (!(level > 1e-9)) return -std::min({section.half_width, section.front, section.back});
  return (level - 1.0) * reach / level;
}

Sphere bounds_of(const Sphere& sphere) { return sphere; }

Sphere bounds_of(const RoundCone& cone) {
  const Eigen::Vector3d centre = 0.5 * (cone.from.centre + cone.to.centre);
  const double half = 0.5 * (cone.from.centre - cone.to.centre).norm();
  return {centre, half + std::max(cone.from.radius, cone.to.radius)};
}

Sphere bounds_of(const Ellipsoid& ellipsoid) { return {ellipsoid.centre, ellipsoid.radii.maxCoeff()}; }

Sphere bounds_of(const Loft& loft) {
  const Section& bottom = loft.sections.front();
  const Section& top = loft.sections.back();
  const Eigen::Vector3d low(bottom.x, bottom.y - loft.bottom_cap, bottom.z);
  const Eigen::Vector3d high(top.x, top.y + loft.top_cap, top.z);
  const Eigen::Vector3d centre = 0.5 * (low + high);
  double radius = 0.5 * (high - low).norm();
  for (const Section& section : loft.sections) {
    const double width = std::abs(section.x - centre.x()) + section.half_width;
    const double depth = std::abs(section.z - centre.z()) + std::max(section.front, section.back);
    radius = std::max(radius, Eigen::Vector3d(width, section.y - centre.y(), depth).norm());
  }
  const double end = std::max(std::max(bottom.half_width, bottom.front), std::max(top.half_width, top.front));
  return {centre, std::max(radius, std::hypot(0.5 * (high - low).norm(), end))};
}

}  // namespace

Loft::Loft(std::vector<Section> given, double bottom, double top, double oval)
    : sections(std::move(given)), bottom_cap(bottom), top_cap(top), exponent(oval), slopes_(sections.size()) {
  assert(sections.size() >= 2);
  const std::size_t last = sections.size() - 1;
  const auto secant = [&](std::size_t i, std::size_t value) {
    return (values_of(sections[i + 1])[value] - values_of(sections[i])[value]) /
           (sections[i + 1].y - sections[i].y);
  };
  for (std::size_t value = 0; value < section_values; ++value) {
    slopes_[0][value] = secant(0, value);
    slopes_[last][value] = secant(last - 1, value);
    for (std::size_t i = 1; i < last; ++i) {
      slopes_[i][value] = monotone_slope(sections[i].y - sections[i - 1].y, secant(i - 1, value),
                                         sections[i + 1].y - sections[i].y, secant(i, value));
    }
  }
}

Section Loft::at(double y) const {
  const auto after =
      std::upper_bound(sections.begin() + 1, sections.end() - 1, y,
                       [](double height, const Section& section) { return height < section.y; });
  const auto right = static_cast<std::size_t>(after - sections.begin());
  const std::size_t left = right - 1;
  const double width = sections[right].y - sections[left].y;
  const double s = (y - sections[left].y) / width;
  const std::array<double, section_values> low = values_of(sections[left]);
  const std::array<double, section_values> high = values_of(sections[right]);
  std::array<double, section_values> value;
  for (std::size_t i = 0; i < section_values; ++i) {
    const double cubic = s * s * (3.0 - 2.0 * s);
    value[i] = low[i] + cubic * (high[i] - low[i]) +
               width * s * (1.0 - s) * ((1.0 - s) * slopes_[left][i] - s * slopes_[right][i]);
  }
  return {y, value[0], value[1], value[2], value[3], value[4]};
}

double distance(const Shape& shape, const Eigen::Vector3d& point) {
  return std::visit([&](const auto& each) { return distance_to(each, point); }, shape);
}

Sphere bounding_sphere(const Shape& shape) {
  return std::visit([](const auto& each) { return bounds_of(each); }, shape);
}

}  // namespace bespoke
