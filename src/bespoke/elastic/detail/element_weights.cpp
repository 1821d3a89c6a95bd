#include "bespoke/elastic/detail/element_weights.h"

#include <cmath>

#include "bespoke/parallel.h"

namespace bespoke {

namespace {

/// Weights by cell, 0 where a cell is not among the finest.
std::vector<double> weights_of_cells(const ElementLevel& level) {
  std::vector<double> weights(level.cells.size(), 0.0);
  for (std::size_t number = 0; number < level.finest.size(); ++number)
    weights[static_cast<std::size_t>(level.finest[number])] = level.weights[number];
  return weights;
}

}  // namespace

std::vector<std::vector<double>> element_weights(const NestedElements& elements,
                                                 const ClosestPointTree& surface, double lambda,
                                                 const NestedElements* before) {
  constexpr double far_weight = 1.0 / 30, half_way = 0.4;  // the latter of λ
  constexpr double farthest = 2;                           // of λ: no cell is beyond
  std::vector<std::vector<double>> weights;
  for (std::size_t k = 0; k < elements.levels().size(); ++k) {
    const ElementLevel& level = elements.levels()[k];
    const Lattice lattice = elements.lattice(k);
    const ElementLevel* known =
        before != nullptr && k < before->levels().size() ? &before->levels()[k] : nullptr;
    const std::vector<double> known_weights = known ? weights_of_cells(*known) : std::vector<double>{};
    std::vector<double>& of_level = weights.emplace_back(level.finest.size());
    parallel_for(of_level.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t number = begin; number < end; ++number) {
        const LatticeCoordinates& cell = level.cells[static_cast<std::size_t>(level.finest[number])];
        const int found = known ? known->cell_table.find(cell) : no_leaf;
        if (found != no_leaf && known_weights[static_cast<std::size_t>(found)] > 0) {
          of_level[number] = known_weights[static_cast<std::size_t>(found)];
          continue;
        }
        const Vector3 middle = lattice(cell) + Vector3::Constant(level.voxel_size / 2);
        const auto closest = surface.closest(middle, {.max_distance = farthest * lambda});
        const double ratio = (closest ? (closest->point - middle).norm() / lambda : farthest) / half_way;
        of_level[number] = far_weight + (1 - far_weight) / (1 + ratio * ratio);
      }
    });
  }
  return weights;
}

}  // namespace bespoke
