#include <algorithm>
#include <cmath>

#include "bespoke/asset/detail/preview.h"
#include "bespoke/error.h"
#include "bespoke/lattice/leaf_table.h"

namespace bespoke {
namespace {

constexpr double voxels_along_diagonal = 128;
constexpr float band_voxels = 3;

// A scalar grid between its nodes; the background where a node has no leaf.
class ScalarSampler {
 public:
  explicit ScalarSampler(const StoredGrid& grid) : grid_(grid), table_(grid.leaves) {}

  float operator()(const Vector3& x) const {
    const Vector3 lattice = (x - grid_.origin) / grid_.voxel_size;
    if (!(lattice.cwiseAbs().maxCoeff() < 1 << 28)) return grid_.background;
    const Eigen::Vector3i lower = lattice.array().floor().cast<int>();
    const Vector3 f = lattice - lower.cast<double>();
    double sum = 0;
    for (int n = 0; n < 8; ++n) {
      const Eigen::Vector3i d(n >> 2 & 1, n >> 1 & 1, n & 1);
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis) weight *= d[axis] ? f[axis] : 1 - f[axis];
      sum += weight * node(lower + d);
    }
    return static_cast<float>(sum);
  }

 private:
  // Distances from both sides look alike: beyond the band their sign is not stored.
  double node(const Eigen::Vector3i& at) const {
    const int leaf = table_.find({at.x() >> 3, at.y() >> 3, at.z() >> 3});
    if (leaf == no_leaf) return grid_.background;
    const int in_leaf = ((at.x() & 7) * leaf_edge + (at.y() & 7)) * leaf_edge + (at.z() & 7);
    return std::abs(
        grid_.values[static_cast<std::size_t>(leaf) * leaf_nodes + static_cast<std::size_t>(in_leaf)]);
  }

  const StoredGrid& grid_;
  LeafTable table_;
};

}  // namespace

StoredGrid carried_distance(const StoredGrid& distance, const Box& box,
                            const std::function<Points(const Points&)>& map_back) {
  StoredGrid grid;
  grid.name = source_distance_name;
  grid.components = 1;
  grid.grid_class = GridClass::level_set;
  grid.voxel_size = box.diagonal().norm() / voxels_along_diagonal;
  grid.origin = box.min();
  const auto voxel = static_cast<float>(grid.voxel_size);
  grid.background = band_voxels * voxel;
  grid.metadata["bespoke:meaning"] = std::string(
      "unsigned distance to the source model, carried from the other model's, minus one voxel: a shell");
  const ScalarSampler sample(distance);
  const Eigen::Vector3i last = ((box.sizes() / grid.voxel_size).array() / leaf_edge).floor().cast<int>() + 1;
  for (int i = -1; i <= last.x(); ++i)
    for (int j = -1; j <= last.y(); ++j) {
      const int row = last.z() + 2;
      Points x(3, row * leaf_nodes);
      for (int n = 0; n < row * leaf_nodes; ++n) {
        const int node = n % leaf_nodes;
        x.col(n) =
            grid.origin + grid.voxel_size * Vector3(leaf_edge * i + node / 64, leaf_edge * j + node / 8 % 8,
                                                    leaf_edge * (n / leaf_nodes - 1) + node % 8);
      }
      const Points back = map_back(x);
      for (int k = 0; k < row; ++k) {
        std::array<float, leaf_nodes> values;
        LeafMask mask{};
        for (int node = 0; node < leaf_nodes; ++node) {
          const float value = sample(back.col(k * leaf_nodes + node)) - voxel;
          values[static_cast<std::size_t>(node)] = std::min(value, grid.background);
          if (value < grid.background)
            mask[static_cast<std::size_t>(node / 64)] |= std::uint64_t{1} << (node % 64);
        }
        if (std::all_of(mask.begin(), mask.end(), [](std::uint64_t word) { return word == 0; })) continue;
        grid.leaves.push_back({i, j, k - 1});
        grid.active.push_back(mask);
        grid.values.insert(grid.values.end(), values.begin(), values.end());
      }
    }
  if (grid.leaves.empty()) throw InvalidInput("the source's distance grid has no surface within the box");
  return grid;
}

}  // namespace bespoke
