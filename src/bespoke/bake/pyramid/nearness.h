#pragma once

#include <vector>

#include "bespoke/lattice/lattice.h"
#include "bespoke/lattice/leaf.h"
#include "bespoke/mesh/closest_point.h"

namespace bespoke {

/// How much an error counts where not all can be repaired: most on the model, since that is where products
/// lie.
class Nearness {
 public:
  explicit Nearness(const TriangleMesh& surface);

  /// 1 / (1 + d / ℓ) of each leaf, where d is its distance from the surface and ℓ 0.1 % of the surface's
  /// diagonal.
  std::vector<double> weights(const Lattice& lattice, const std::vector<LeafCoordinates>& leaves) const;

 private:
  ClosestPointTree surface_;
  double length_;  // ℓ, mesh units
};

}  // namespace bespoke
