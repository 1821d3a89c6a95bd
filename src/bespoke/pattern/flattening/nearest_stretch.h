#pragma once

#include <Eigen/Core>

#include "bespoke/pattern/flatten_pieces.h"

namespace bespoke {

/// The matrix that a face's Jacobian is drawn towards: of the nearest rotation, the nearest similarity, or
/// the nearest matrix of determinant 1. The scale of similarities is the face's own.
Eigen::Matrix2d nearest_stretch(FlatteningMethod method, const Eigen::Matrix2d& jacobian);

/// The smallest s > 0 at which det(a + s b) = 0; infinite without one. det a > 0.
double unflipped_step(const Eigen::Matrix2d& a, const Eigen::Matrix2d& b);

}  // namespace bespoke
