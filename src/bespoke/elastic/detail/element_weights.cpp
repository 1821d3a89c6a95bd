#include "bespoke/elastic/detail/element_weights.h"

#include <cmath>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/parallel.h"

namespace bespoke {

std::vector<std::vector<double>> element_weights(const NestedElements& elements, const TriangleMesh& surface,
                                                 double lambda) {
  constexpr double far_weight = 1.0 / 30, half_way = 0.4;  // the latter of λ
  constexpr double farthest = 2;                           // of λ: no cell is beyond
  const ClosestPointTree tree(surface);
  std::vector<std::vector<double>> weights;
  for (std::size_t k = 0; k < elements.levels().size(); ++k) {
    const ElementLevel& level = elements.levels()[k];
    const Lattice lattice = elements.lattice(k);
    std::vector<double>& of_level = weights.emplace_back(level.finest.size());
    parallel_for(of_level.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t number = begin; number < end; ++number) {
        const auto cell = static_cast<std::size_t>(level.finest[number]);
        const Vector3 middle = lattice(level.cells[cell]) + Vector3::Constant(level.voxel_size / 2);
        const auto closest = tree.closest(middle, {.max_distance = farthest * lambda});
        const double ratio = (closest ? (closest->point - middle).norm() / lambda : farthest) / half_way;
        of_level[number] = far_weight + (1 - far_weight) / (1 + ratio * ratio);
      }
    });
  }
  return weights;
}

}  // namespace bespoke
