#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/bake/bake.h"
#include "bespoke/lattice/lattice.h"

namespace bespoke {

/// An octant that needs a leaf of its own, and gets none: the pyramid has as many leaves as it may have.
struct RefusedOctant {
  std::size_t level = 0;  ///< of the leaf that it would get
  LeafCoordinates leaf{};
  double error = 0;    ///< largest that was found in it, mesh units
  double urgency = 0;  ///< the error as it counts there (Nearness)
};

/// Refused octants that lie in neighbouring leaves of the coarsest level, as one region; the worst first.
std::vector<RelaxedRegion> relaxed_regions(const Lattice& coarsest,
                                           const std::vector<RefusedOctant>& refused);

}  // namespace bespoke
