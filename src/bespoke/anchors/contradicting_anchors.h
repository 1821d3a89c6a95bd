#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"

namespace bespoke {

/// Two exact pairs so close that no smooth map meets both.
struct ContradictingAnchors {
  std::size_t first = 0, second = 0;  ///< indices of the pairs
  double source_distance = 0;         ///< the two sources, as large as the target is, mesh units
  double target_difference = 0;  ///< how much more or less their targets are apart, as vectors, mesh units
};

/// Pairs of exact anchors within 5 % of the targets' diagonal whose targets differ from what the one
/// similarity of all pairs makes of their sources by more than their distance, and also from what the
/// similarity of the pairs around them does: a hand may have flipped. Between anchors farther apart a
/// joint may bend; between these the map would have to stretch space twofold or fold it. Differences up to
/// the root mean square of those of two places accurate to 0.1 % of the targets' diagonal, as remeshing
/// leaves them, say nothing. sigmas: as a fit took the pairs, one each, mesh units; empty where it is not
/// known. By decreasing ratio. None among fewer than 4 pairs.
std::vector<ContradictingAnchors> contradicting_anchors(const Anchors& anchors,
                                                        const std::vector<double>& sigmas = {});

/// One line, empty without any: the names, the distances and what to do.
std::string to_string(const std::vector<ContradictingAnchors>& contradicting, const Anchors& anchors);

}  // namespace bespoke
