#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"
#include "bespoke/volume/band.h"
#include "bespoke/volume/pyramid.h"

namespace bespoke {

/// u at all nodes of the leaves as PyramidLevel::values has them. Throws InvalidInput when the map answers
/// with a value that is not finite.
std::vector<float> sample_leaves(const ElasticMap& map, const Lattice& lattice,
                                 const std::vector<LeafCoordinates>& leaves, const Progress& progress);

/// A level of the leaves that are not zero everywhere, holding u. Throws as sample_leaves does.
PyramidLevel sample_level(const ElasticMap& map, const Lattice& lattice,
                          const std::vector<LeafCoordinates>& leaves, const Progress& progress);

/// Drops the leaves for which `keep(leaf, all values are zero)` is false.
void keep_leaves(PyramidLevel& level,
                 const std::function<bool(const LeafCoordinates& leaf, bool zero)>& keep);

/// `count` points of the leaves' cells, as many in one leaf as in another, in the leaves' order; the same for
/// the same seed. 3×count, mesh units.
Points random_points(const Lattice& lattice, const std::vector<LeafCoordinates>& leaves, std::size_t count,
                     std::uint64_t seed);

/// 27 points in each finest cell that holds a column of `at`, spread over the cell; from every so many
/// columns only, so that there are at most `count` points. The same for the same seed. Mesh units.
Points points_in_cells_at(const Pyramid& pyramid, const Points& at, std::size_t count, std::uint64_t seed);

/// |u of `baked` − u of `exact`| at each column of x, mesh units.
std::vector<double> displacement_errors(const ElasticMap& baked, const ElasticMap& exact, const Points& x,
                                        const Progress& progress);

}  // namespace bespoke
