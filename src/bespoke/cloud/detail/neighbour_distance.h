#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// Of every column of points (3×n, finite, all different, n > k) the distance to its k-th neighbour, k ≥ 1,
/// mesh units; infinite where it exceeds about eight times the median.
std::vector<double> neighbour_distances(const Points& points, std::size_t k);

}  // namespace bespoke
