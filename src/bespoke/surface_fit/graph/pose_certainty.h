#pragma once

#include "bespoke/types.h"

namespace bespoke {

/// How certainly anchors determine the pose around points of a source that they have posed, 0 to 1:
/// exp(−(d / r)²) with d the distance of the third nearest anchor, since three determine a rotation; 0 for
/// fewer. vertices: 3×n, anchors: 3×k, reach: r > 0, mesh units.
Eigen::VectorXd pose_certainty(const Points& vertices, const Points& anchors, double reach);

}  // namespace bespoke
