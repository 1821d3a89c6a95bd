#pragma once

#include <vector>

#include "bespoke/lattice/baked_map.h"

namespace bespoke {

struct NewtonWalks {
  Points x;                           ///< 3×n, mesh units; where a walk stalled, the best place it came to
  std::vector<Eigen::Index> stalled;  ///< columns, increasing
};

/// Looks for x with |E(x) − y| ≤ tolerance (mesh units) for the columns of y by damped Newton steps through
/// the trilinear cells, from the columns of `start`. Converges in three to six steps where it does; a walk
/// stalls where even a small step does not reduce the residual, or the steps are used up.
NewtonWalks walk_to_preimages(const BakedMap& map, const Points& y, const Points& start, double tolerance);

}  // namespace bespoke
