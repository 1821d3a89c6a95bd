#include "solid.h"

#include "bespoke/error.h"

#include <algorithm>
#include <cmath>

namespace bespoke {
namespace {

Eigen::Affine3d mirror() { return Eigen::Affine3d(Eigen::Scaling(-1.0, 1.0, 1.0)); }

double scale_of(const Eigen::Affine3d& similarity) {
  return std::cbrt(std::abs(similarity.linear().determinant()));
}

}  // namespace

double smooth_min(double a, double b, double width) {
  if (!(width > 0.0)) return std::min(a, b);
  const double overlap = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - overlap * overlap * overlap * width / 6.0;
}

double smooth_max(double a, double b, double width) { return -smooth_min(-a, -b, width); }

Eigen::Vector3d gradient(const Field& field, const Eigen::Vector3d& point) {
  const double step = 1e-3;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : {Eigen::Vector3d(1, -1, -1), Eigen::Vector3d(-1, -1, 1),
                                        Eigen::Vector3d(-1, 1, -1), Eigen::Vector3d(1, 1, 1)}) {
    sum += corner * field(point + step * corner);
  }
  return sum / (4.0 * step);
}

Eigen::Vector3d project(const Field& field, const Eigen::Vector3d& point) {
  Eigen::Vector3d moved = point;
  for (int step = 0; step < 8; ++step) {
    const double value = field(moved);
    if (std::abs(value) < 1e-5) break;
    const Eigen::Vector3d slope = gradient(field, moved);
    moved -= value * slope / std::max(slope.squaredNorm(), 0.05);
  }
  return moved;
}

Eigen::Vector3d leave(const Field& field, const Eigen::Vector3d& inside, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d unit = direction.normalized();
  const double step = 0.1;
  double low = 0.0;
  double high = 0.0;
  while (field(inside + high * unit) < 0.0 && high < 100.0) {
    low = high;
    high += step;
  }
  if (!(high > 0.0 && high < 100.0)) {
    throw SolverError("a landmark's ray does not leave the surface: it starts at (" +
                      std::to_string(inside.x()) + ", " + std::to_string(inside.y()) + ", " +
                      std::to_string(inside.z()) + ")");
  }
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = 0.5 * (low + high);
    (field(inside + middle * unit) < 0.0 ? low : high) = middle;
  }
  return inside + high * unit;
}

Solid& Solid::append(const Shape& shape, const Eigen::Affine3d& solid_from_shape, double fillet,
                     bool carved) {
  const Sphere bounds = bounding_sphere(shape);
  const double scale = scale_of(solid_from_shape);
  parts_.push_back({shape,
                    solid_from_shape.inverse(),
                    scale,
                    fillet,
                    carved,
                    {solid_from_shape * bounds.centre, bounds.radius * scale}});
  return *this;
}

Solid& Solid::add(const Shape& shape, double fillet) {
  return append(shape, Eigen::Affine3d::Identity(), fillet, false);
}

Solid& Solid::carve(const Shape& shape, double fillet) {
  return append(shape, Eigen::Affine3d::Identity(), fillet, true);
}

Solid& Solid::add_both(const Shape& shape, double fillet) {
  add(shape, fillet);
  return append(shape, mirror(), fillet, false);
}

Solid& Solid::carve_both(const Shape& shape, double fillet) {
  carve(shape, fillet);
  return append(shape, mirror(), fillet, true);
}

Solid& Solid::add(const Solid& other, const Eigen::Affine3d& here_from_other, double fillet) {
  const double scale = scale_of(here_from_other);
  for (const Part& part : other.parts_) {
    const bool first = &part == &other.parts_.front();
    append(part.shape, here_from_other * part.shape_from_solid.inverse(),
           first ? fillet : part.fillet * scale, part.carved);
  }
  return *this;
}

double Solid::operator()(const Eigen::Vector3d& point) const {
  double value = 1e3;
  for (const Part& part : parts_) {
    const double nearest = (point - part.bounds.centre).norm() - part.bounds.radius;
    // Beyond the fillet a part changes nothing; the factor allows for shapes that underestimate their
    // distance.
    const double reach = 1.5 * part.fillet;
    if (nearest > (part.carved ? -value : value) + reach) continue;
    const double here = part.scale * distance(part.shape, part.shape_from_solid * point);
    value = part.carved ? smooth_max(value, -here, part.fillet) : smooth_min(value, here, part.fillet);
  }
  return value;
}

}  // namespace bespoke
