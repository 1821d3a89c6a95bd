#include "bespoke/elastic/detail/element_band.h"

#include <utility>

#include "bespoke/lattice/leaf_table.h"
#include "bespoke/parallel.h"

namespace bespoke {

std::vector<LatticeCoordinates> nodes_near(const ClosestPointTree& surface, const Box& box,
                                           const Lattice& lattice, double lambda) {
  const LatticeCoordinates low = lattice.cell_of(box.min() - Vector3::Constant(lambda)),
                           high = lattice.cell_of(box.max() + Vector3::Constant(lambda));
  std::vector<std::vector<LatticeCoordinates>> slabs(static_cast<std::size_t>(high[0] - low[0] + 2));
  parallel_for(slabs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slab = begin; slab < end; ++slab)
      for (int j = low[1]; j <= high[1] + 1; ++j)
        for (int k = low[2]; k <= high[2] + 1; ++k) {
          const LatticeCoordinates node{low[0] + static_cast<int>(slab), j, k};
          if (surface.closest(lattice(node), {.max_distance = lambda})) slabs[slab].push_back(node);
        }
  });
  std::vector<LatticeCoordinates> nodes;
  for (const auto& slab : slabs) nodes.insert(nodes.end(), slab.begin(), slab.end());
  return nodes;
}

void add_nodes_within(const Lattice& lattice, const Vector3& x, double lambda,
                      std::vector<LatticeCoordinates>& nodes) {
  const LatticeCoordinates low = lattice.cell_of(x - Vector3::Constant(lambda)),
                           high = lattice.cell_of(x + Vector3::Constant(lambda));
  for (int i = low[0]; i <= high[0] + 1; ++i)
    for (int j = low[1]; j <= high[1] + 1; ++j)
      for (int k = low[2]; k <= high[2] + 1; ++k)
        if ((lattice({i, j, k}) - x).norm() <= lambda) nodes.push_back({i, j, k});
}

void add_nodes_of_cells_around(const Lattice& lattice, const Points& points,
                               std::vector<LatticeCoordinates>& nodes) {
  std::vector<LatticeCoordinates> cells;
  for (const auto& x : points.colwise()) cells.push_back(lattice.cell_of(x));
  for (const LatticeCoordinates& cell : unique_leaves(std::move(cells)))
    for (int i = -1; i <= 2; ++i)
      for (int j = -1; j <= 2; ++j)
        for (int k = -1; k <= 2; ++k) nodes.push_back(moved(cell, {i, j, k}));
  nodes = unique_leaves(std::move(nodes));
}

void add_nodes_around(const Lattice& lattice, const Vector3& x, std::vector<LatticeCoordinates>& nodes) {
  constexpr double refined_reach = 2;  // voxels
  const Vector3 at = (x - lattice.origin) / lattice.voxel_size;
  const Eigen::Vector3i low = (at.array() - refined_reach).ceil().cast<int>(),
                        high = (at.array() + refined_reach).floor().cast<int>();
  for (int i = low[0]; i <= high[0]; ++i)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int k = low[2]; k <= high[2]; ++k) nodes.push_back({i, j, k});
}

}  // namespace bespoke
