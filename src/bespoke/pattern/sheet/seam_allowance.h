#pragma once

#include <Eigen/Core>
#include <vector>

#include "bespoke/pattern/pattern_sheet.h"

namespace bespoke {

/// Closed lines at a distance (> 0, millimetres) outside a closed line, 2×n, counter-clockwise; where the
/// corner of a mitre would be farther than twice that, it is squared. To 1e-4 mm (Clipper, Vatti's algorithm,
/// on integers).
std::vector<std::vector<Eigen::Vector2d>> with_allowance(const Eigen::Matrix2Xd& outline, double allowance,
                                                         AllowanceCorners corners);

}  // namespace bespoke
