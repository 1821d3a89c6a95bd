#pragma once

#include <utility>
#include <vector>

#include "bespoke/mapping/elastic_map.h"

namespace bespoke {

/// amplitude · (1 − s²)⁴ with s = |frame·x − center| / radius, 0 beyond: three times continuously
/// differentiable, so that trilinear interpolation has order 2.
struct Bump {
  Vector3 center;
  double radius;
  Vector3 amplitude;
};

/// A map whose values and gradients are known in closed form.
class AnalyticMap : public ElasticMap {
 public:
  explicit AnalyticMap(std::vector<Bump> bumps, AffineMap affine = {}, AffineMap frame = {})
      : bumps_(std::move(bumps)), affine_(std::move(affine)), frame_(std::move(frame)) {}

  AffineMap affine() const override { return affine_; }

  Points displacement(const Points& x) const override {
    Points u = Points::Zero(3, x.cols());
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      for (const Bump& bump : bumps_) {
        const Vector3 d = (frame_ * Vector3(x.col(i)) - bump.center) / bump.radius;
        const double q = 1 - d.squaredNorm();
        if (q > 0) u.col(i) += bump.amplitude * (q * q * q * q);
      }
    return u;
  }

  Points displacement_gradient(const Points& x) const override {
    Points gradient = Points::Zero(3, 3 * x.cols());
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      for (const Bump& bump : bumps_) {
        const Vector3 d = (frame_ * Vector3(x.col(i)) - bump.center) / bump.radius;
        const double q = 1 - d.squaredNorm();
        if (q > 0)
          gradient.middleCols<3>(3 * i) +=
              bump.amplitude * (-8 * q * q * q / bump.radius * d.transpose() * frame_.linear);
      }
    return gradient;
  }

  Support support() const override {
    Support support;
    support.frame = frame_;
    for (const Bump& bump : bumps_) support.clouds.push_back({bump.center, bump.radius});
    return support;
  }

 private:
  std::vector<Bump> bumps_;
  AffineMap affine_;
  AffineMap frame_;
};

}  // namespace bespoke
