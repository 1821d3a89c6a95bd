#pragma once

#include "bespoke/fitting/target_surface.h"

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

struct SimilarityFit {
  Similarity target_from_source;
  double residual = 0;  ///< 90th percentile of the distances to the target's tangent planes, mesh units
  bool suffices = false;
};

/// Iterated closest compatible points, point to plane, robust weights, from `start` on. `tolerance`, mesh
/// units: the similarity suffices when `residual` is within it. Gives up early when no similarity can.
SimilarityFit fit_similarity(const TriangleMesh& source, const TargetSurface& target, const Similarity& start,
                             double tolerance);

}  // namespace bespoke
