#pragma once

#include "bespoke/types.h"

namespace bespoke {

/// x ↦ s R x + t.
struct Similarity {
  double scale = 1;  ///< > 0
  Matrix3 rotation = Matrix3::Identity();
  Vector3 translation = Vector3::Zero();  ///< mesh units

  Points operator*(const Points& x) const { return ((scale * rotation) * x).colwise() + translation; }
  Similarity operator*(const Similarity& other) const {
    return {scale * other.scale, rotation * other.rotation,
            scale * (rotation * other.translation) + translation};
  }
};

/// Least squares over point pairs (3×n each, mesh units) with weights ≥ 0 (Umeyama). Throws InvalidInput when
/// all sources coincide.
Similarity align_similarly(const Points& source, const Points& target, const Eigen::VectorXd& weights);

}  // namespace bespoke
