#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"

namespace bespoke {

/// A pair that the map misses by more than its accuracy explains.
struct MissedAnchor {
  std::size_t index = 0;
  double residual = 0;  ///< mesh units of the target
  double sigma = 0;     ///< as the fit took it, 0 for an exact one, mesh units
};

/// Pairs whose residual exceeds four standard deviations, by falling residual over σ. No σ counts as less
/// than `resolution` (> 0, mesh units): what remeshing leaves. Pairs with a weight have no σ, and are none of
/// them. residuals, sigmas: one a pair. Throws InvalidInput for other numbers.
std::vector<MissedAnchor> missed_anchors(const Anchors& anchors, const std::vector<double>& residuals,
                                         const std::vector<double>& sigmas, double resolution);

/// One line, empty without any: the worst, by name, with residual and σ.
std::string to_string(const std::vector<MissedAnchor>& missed, const Anchors& anchors);

}  // namespace bespoke
