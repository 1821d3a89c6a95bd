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

/// Pairs of exact anchors within 5 % of the targets' diagonal whose difference, on the target, is off by more
/// than their distance, both from the similarity of all pairs and from that of the pairs around them: the map
/// would have to stretch twofold or fold. Places are taken as accurate to 0.1 % of the diagonal (remeshing).
/// sigmas: one a pair, mesh units, as a fit took them; empty where not known. By decreasing ratio; none among
/// fewer than 4 pairs.
std::vector<ContradictingAnchors> contradicting_anchors(const Anchors& anchors,
                                                        const std::vector<double>& sigmas = {});

/// One line, empty without any: the names, the distances and what to do.
std::string to_string(const std::vector<ContradictingAnchors>& contradicting, const Anchors& anchors);

}  // namespace bespoke
