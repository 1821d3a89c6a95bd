#include "bespoke/bake/pyramid/nearness.h"

#include <algorithm>
#include <cmath>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Diagonals: errors count where products lie.
constexpr double relative_length = 1e-3;

}  // namespace

Nearness::Nearness(const TriangleMesh& surface)
    : surface_(surface), length_(relative_length * diagonal(surface.vertices)) {}

std::vector<double> Nearness::weights(const Lattice& lattice,
                                      const std::vector<LeafCoordinates>& leaves) const {
  std::vector<double> result(leaves.size());
  const double half_edge = leaf_edge * lattice.voxel_size / 2;
  constexpr std::size_t grain = 64;
  parallel_for(leaves.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const Vector3 center = lattice(first_node(leaves[n])) + Vector3::Constant(half_edge);
      const double distance = std::sqrt(surface_.closest(center)->squared_distance) - half_edge;
      result[n] = 1 / (1 + std::max(0.0, distance) / length_);
    }
  });
  return result;
}

}  // namespace bespoke
