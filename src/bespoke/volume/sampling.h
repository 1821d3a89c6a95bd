#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"
#include "bespoke/volume/band.h"
#include "bespoke/volume/pyramid.h"

namespace bespoke {

/// u at all nodes of the leaves, stored as floats; leaves that are zero everywhere are left out. Throws
/// InvalidInput when the map answers with a value that is not finite.
PyramidLevel sample_level(const ElasticMap& map, const Lattice& lattice,
                          const std::vector<LeafCoordinates>& leaves, const Progress& progress);

/// `count` points of the leaves' cells, as many in one leaf as in another, in the leaves' order; the same for
/// the same seed. 3×count, mesh units.
Points random_points(const Lattice& lattice, const std::vector<LeafCoordinates>& leaves, std::size_t count,
                     std::uint64_t seed);

/// |u of `baked` − u of `exact`| at each column of x, mesh units.
std::vector<double> displacement_errors(const ElasticMap& baked, const ElasticMap& exact, const Points& x,
                                        const Progress& progress);

}  // namespace bespoke
