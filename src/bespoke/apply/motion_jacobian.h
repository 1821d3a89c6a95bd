#pragma once

#include <vector>

#include "bespoke/mapping/mapping.h"

namespace bespoke {

/// The Jacobians of Ψ(t), as apply_mapping computes it, at the columns of x (3×n, source frame, mesh units):
/// one 3×3n matrix a time, three columns a point, entry (i, j) the derivative of coordinate i by x_j. The
/// identity, exactly, at t = 0. Throws as apply_mapping.
std::vector<Points> motion_jacobian(const ElasticMap& elastic, const RigidTransform& target_from_source,
                                    const Points& x, const std::vector<double>& times,
                                    const MotionOptions& motion = {});

}  // namespace bespoke
