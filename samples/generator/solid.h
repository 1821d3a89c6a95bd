#pragma once

#include "shapes.h"

#include <Eigen/Geometry>
#include <functional>
#include <vector>

namespace bespoke {

/// An implicit surface: negative inside, zero on it, close to the signed distance near it (cm).
using Field = std::function<double(const Eigen::Vector3d&)>;

/// Minimum and maximum with a fillet of about the given width (cm), twice continuously differentiable. Width
/// 0: the plain ones.
double smooth_min(double a, double b, double width);
double smooth_max(double a, double b, double width);

Eigen::Vector3d gradient(const Field& field, const Eigen::Vector3d& point);

/// The nearest zero of the field along its gradient.
Eigen::Vector3d project(const Field& field, const Eigen::Vector3d& point);

/// First point where the ray leaves the field's inside. Throws SolverError if it never does within 100 cm or
/// starts outside.
Eigen::Vector3d leave(const Field& field, const Eigen::Vector3d& inside, const Eigen::Vector3d& direction);

/// Shapes added to and carved from one another in order, each with a fillet of its own.
class Solid {
 public:
  Solid& add(const Shape& shape, double fillet);
  Solid& carve(const Shape& shape, double fillet);
  /// Both a shape and its mirror image about x = 0.
  Solid& add_both(const Shape& shape, double fillet);
  Solid& carve_both(const Shape& shape, double fillet);
  /// Another solid, moved by a similarity; its first part meets this solid with the given fillet.
  Solid& add(const Solid& other, const Eigen::Affine3d& here_from_other, double fillet);

  double operator()(const Eigen::Vector3d& point) const;

 private:
  struct Part {
    Shape shape;
    Eigen::Affine3d shape_from_solid;
    double scale;
    double fillet;
    bool carved;
    Sphere bounds;
  };

  Solid& append(const Shape& shape, const Eigen::Affine3d& solid_from_shape, double fillet, bool carved);

  std::vector<Part> parts_;
};

}  // namespace bespoke
