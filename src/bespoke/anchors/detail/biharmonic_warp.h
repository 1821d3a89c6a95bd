#pragma once

#include <Eigen/Dense>

#include "bespoke/types.h"

namespace bespoke {

/// The smooth warp of least bending through pairs of points: the kernel −|x − y|, the biharmonic spline's in
/// space, with an affine tail.
class BiharmonicWarp {
 public:
  /// 3×n each, mesh units.
  BiharmonicWarp(const Points& sources, const Points& targets);

  Vector3 operator()(const Vector3& x) const;

  /// Distance of pair i from where the others would put it, without solving again, mesh units.
  double left_out(Eigen::Index i) const;

  /// Bending energy of the warp.
  double energy() const;

  /// The same without pair i, without solving again.
  double energy_without(Eigen::Index i) const;

  /// The same if the targets of pairs i and j were interchanged, without solving again.
  double energy_interchanged(Eigen::Index i, Eigen::Index j) const;

 private:
  double stiffness(Eigen::Index i) const;  // how much moving target i by a length bends the warp

  Points sources_, targets_;
  Eigen::MatrixXd inverse_, coefficients_;
};

}  // namespace bespoke
