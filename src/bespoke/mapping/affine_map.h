#pragma once

#include "bespoke/rigid/rigid_transform.h"
#include "bespoke/types.h"

namespace bespoke {

/// x ↦ outer(inner(x)).
AffineMap compose(const AffineMap& outer, const AffineMap& inner);

/// Throws InvalidInput for a singular map.
AffineMap inverse(const AffineMap& map);

/// How many times as large it makes models: the cube root of |det|.
double size_ratio(const AffineMap& map);

/// The same in powers of two (length.h): what sizes before and after the map are compared by.
double power_of_two_scale(const AffineMap& map);

AffineMap as_affine(const RigidTransform& transform);

}  // namespace bespoke
