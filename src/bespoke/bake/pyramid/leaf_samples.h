#pragma once

#include <functional>
#include <vector>

#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"

namespace bespoke {

/// u at all nodes of the leaves as PyramidLevel::values has them. Throws InvalidInput when the map returns
/// with a value that is not finite.
std::vector<float> sample_leaves(const ElasticMap& map, const Lattice& lattice,
                                 const std::vector<LeafCoordinates>& leaves, const Progress& progress);

/// A level of the leaves that are not zero everywhere, holding u. Throws as sample_leaves does.
PyramidLevel sample_level(const ElasticMap& map, const Lattice& lattice,
                          const std::vector<LeafCoordinates>& leaves, const Progress& progress);

/// Drops the leaves for which `keep(leaf, all values are zero)` is false.
void keep_leaves(PyramidLevel& level,
                 const std::function<bool(const LeafCoordinates& leaf, bool zero)>& keep);

}  // namespace bespoke
