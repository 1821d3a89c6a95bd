#pragma once

#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// A permutation of the columns of x (3×n) along a Morton curve, so that neighbours in the result lie near
/// each other; columns at one place, and those with a non-finite coordinate, follow their index.
std::vector<int> spatial_order(const Points& x);

}  // namespace bespoke
