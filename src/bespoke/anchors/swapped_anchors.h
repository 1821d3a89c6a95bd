#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"

namespace bespoke {

/// Two pairs whose targets are interchanged.
struct SwappedAnchors {
  std::size_t first = 0, second = 0;  ///< indices of the pairs, first < second
  double energy_ratio = 0;  ///< bending of the warp with the targets changed back, over that without
};

/// Pairs that, changed back, lower the bending energy of the smoothest warp through all pairs to 0.7 at most,
/// and below what it is without either of them: else one alone is wrong. The two that lower it most are
/// taken, changed back, and the search goes on. Pairs with a weight or a σ above 0
/// are looked at like the others. None among fewer than 6 pairs. Throws InvalidInput for values that are not
/// finite.
std::vector<SwappedAnchors> swapped_anchors(const Anchors& anchors);

/// One line, empty without any.
std::string to_string(const std::vector<SwappedAnchors>& swapped, const Anchors& anchors);

}  // namespace bespoke
