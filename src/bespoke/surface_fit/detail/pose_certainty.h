#pragma once

#include "bespoke/types.h"

namespace bespoke {

/// How surely anchors have told the pose about points of a source that they have bent, 0 to 1: exp(−(d / r)²)
/// with d the distance of the third nearest, since three tell a turn; 0 of fewer anchors. vertices: 3×n,
/// anchors: 3×k, reach: r > 0, mesh units.
Eigen::VectorXd pose_certainty(const Points& vertices, const Points& anchors, double reach);

}  // namespace bespoke
