#pragma once

#include "bespoke/types.h"

namespace bespoke {

/// How far points spread about their mean: the singular values of the 3×n matrix of their differences from it
/// (mesh units, the largest first), and its left singular vectors, the directions in which they do.
struct PrincipalWidths {
  Vector3 widths;
  Matrix3 directions;
};

/// Of at least one point. Zero widths mean a plane, a line or one place, to the rounding of the largest.
PrincipalWidths principal_widths(const Points& points);

}  // namespace bespoke
