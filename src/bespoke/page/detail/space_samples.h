#pragma once

#include <array>
#include <vector>

#include "bespoke/lattice/lattice.h"
#include "bespoke/mapping/elastic_map.h"

namespace bespoke {

/// A lattice of points of the source's space, x slowest, for pictures of what a map does to space.
struct SpaceLattice {
  Lattice lattice;
  std::array<int, 3> size{};  ///< nodes along each axis, at least 2

  Points nodes() const;
};

/// Over the box, about as fine as `nodes` (≥ 8) allow, equally along all axes.
SpaceLattice space_lattice(const Box& box, std::size_t nodes);

/// det ∇E at the columns of x, no unit.
std::vector<double> determinants(const ElasticMap& elastic, const Points& x);

}  // namespace bespoke
