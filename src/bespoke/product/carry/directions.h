#pragma once

#include "bespoke/types.h"

namespace bespoke {

/// To which text files carry directions, of a unit vector.
inline constexpr double direction_resolution = 1e-7;

/// Normals (3×n) where the motion has these Jacobians (3×3n): cof(J) n, as long as n. The cofactor matrix is
/// the inverse transpose times the determinant, so that a normal stays on the side from which its faces are
/// seen counter-clockwise. A normal that is zero or not finite stays as it is.
Points moved_normals(const Points& normals, const Points& jacobians);

/// The mean's direction, as long as they are in the mean; the first one where they cancel.
Vector3 middle_direction(const Vector3& a, const Vector3& b);

/// Tangents: J t, as long as t.
Points moved_tangents(const Points& tangents, const Points& jacobians);

}  // namespace bespoke
