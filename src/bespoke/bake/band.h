#pragma once

#include <vector>

#include "bespoke/lattice/lattice.h"
#include "bespoke/mapping/elastic_map.h"

namespace bespoke {

/// Throws InvalidInput, at once, when the support's frame is singular or a value is not finite, or when the
/// lattice is so fine that its leaves could not be counted.
void require_lattice(const Support& support, const Lattice& lattice);

/// The leaves of a lattice with a node where u may be nonzero, in lexicographic order, and perhaps a few
/// more: the test is conservative. Throws as require_lattice.
std::vector<LeafCoordinates> band_leaves(const Support& support, const Lattice& lattice);

/// Their number, without listing them.
std::size_t count_band_leaves(const Support& support, const Lattice& lattice);

/// Bounding box of the support, mesh units; empty when the support is.
Box bounding_box(const Support& support);

}  // namespace bespoke
