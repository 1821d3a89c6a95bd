#pragma once

#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// Least-squares rotation and translation of weighted point pairs (Eq. 2–6): minimises Σ wᵢ |R qᵢ + T − q'ᵢ|²
/// by the SVD of the cross-covariance (Arun, Umeyama) with the reflection guard, so that det R = +1 always.
/// `source`, `target`: 3×n, mesh units; `weights`: n, > 0 (an infinite weight counts as the largest finite
/// one times 1e6). Throws InvalidInput when the sizes differ, a value is not finite, or the points are fewer
/// than 3 or collinear (second singular value below 1e-9 of the first), naming what is missing.
RigidTransform align_rigidly(const Points& source, const Points& target, const Eigen::VectorXd& weights);

}  // namespace bespoke
