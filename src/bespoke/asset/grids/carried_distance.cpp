#include <algorithm>
#include <array>
#include <cmath>

#include "bespoke/asset/grids/preview.h"
#include "bespoke/error.h"
#include "bespoke/lattice/lattice.h"
#include "bespoke/lattice/leaf_table.h"
#include "bespoke/length.h"

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
    const LatticeCoordinates lower = Lattice{grid_.origin, grid_.voxel_size}.cell_of(x);
    const Vector3 f = lattice - as_vector(lower);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const LatticeCoordinates step = corner_step(corner);
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis) weight *= step[axis] ? f[axis] : 1 - f[axis];
      sum += weight * value_at(moved(lower, step));
    }
    return static_cast<float>(sum);
  }

 private:
  // Distances from both sides look alike: beyond the band their sign is not stored.
  double value_at(const LatticeCoordinates& node) const {
    const int leaf = table_.find(leaf_of(node));
    if (leaf == no_leaf) return grid_.background;
    return std::abs(grid_.values[static_cast<std::size_t>(leaf) * leaf_nodes +
                                 static_cast<std::size_t>(number_of_place(place_in_leaf(node)))]);
  }

  const StoredGrid& grid_;
  LeafTable table_;
};

// Nodes of `count` leaves in a row along z.
Points row_of_nodes(const Lattice& lattice, const LeafCoordinates& first, int count) {
  Points x(3, count * leaf_nodes);
  for (int n = 0; n < count * leaf_nodes; ++n) {
    const LeafCoordinates leaf = moved(first, {0, 0, n / leaf_nodes});
    x.col(n) = lattice(moved(first_node(leaf), place_of_number(n % leaf_nodes)));
  }
  return x;
}

// The leaf unless all its values are the background's.
void add_leaf(const LeafCoordinates& leaf, const std::array<float, leaf_nodes>& distances, StoredGrid& grid) {
  LeafMask mask{};
  for (std::size_t node = 0; node < leaf_nodes; ++node)
    if (distances[node] < grid.background) mask[node / 64] |= std::uint64_t{1} << (node % 64);
  if (std::all_of(mask.begin(), mask.end(), [](std::uint64_t word) { return word == 0; })) return;
  grid.leaves.push_back(leaf);
  grid.active.push_back(mask);
  for (const float distance : distances) grid.values.push_back(std::min(distance, grid.background));
}

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
  const double growth = power_of_two_scale(grid.voxel_size / distance.voxel_size);
  const Lattice lattice{grid.origin, grid.voxel_size};
  const Eigen::Vector3i last = ((box.sizes() / grid.voxel_size).array() / leaf_edge).floor().cast<int>() + 1;
  const int row = last.z() + 2;
  for (int i = -1; i <= last.x(); ++i)
    for (int j = -1; j <= last.y(); ++j) {
      const Points back = map_back(row_of_nodes(lattice, {i, j, -1}, row));
      for (int k = 0; k < row; ++k) {
        std::array<float, leaf_nodes> distances;
        for (int node = 0; node < leaf_nodes; ++node)
          distances[static_cast<std::size_t>(node)] =
              static_cast<float>(growth * sample(back.col(k * leaf_nodes + node))) - voxel;
        add_leaf({i, j, k - 1}, distances, grid);
      }
    }
  if (grid.leaves.empty()) throw InvalidInput("the source's distance grid has no surface within the box");
  return grid;
}

}  // namespace bespoke
