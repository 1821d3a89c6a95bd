#include "bespoke/asset/grids/distance_band.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "bespoke/error.h"
#include "bespoke/lattice/lattice.h"
#include "bespoke/lattice/leaf_table.h"

namespace bespoke {
namespace {

// As source_distance has them, so that both models' bands are of one kind.
constexpr double band_voxels_along_diagonal = 128;
constexpr double band_half_width = 3;

constexpr Eigen::Index max_probes = 10000;

LatticeCoordinates leaf_at(const Lattice& lattice, const Vector3& x) { return leaf_of(lattice.cell_of(x)); }

/// The leaves that the faces' boxes meet, grown by the band.
std::vector<LeafCoordinates> candidate_leaves(const TriangleMesh& mesh, const Lattice& lattice) {
  const double band = band_half_width * lattice.voxel_size;
  std::vector<LeafCoordinates> leaves;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    Box box;
    for (const int vertex : mesh.faces.col(face)) box.extend(Vector3(mesh.vertices.col(vertex)));
    const LeafCoordinates low = leaf_at(lattice, box.min() - Vector3::Constant(band));
    const LeafCoordinates high = leaf_at(lattice, box.max() + Vector3::Constant(band));
    for (int i = low[0]; i <= high[0]; ++i)
      for (int j = low[1]; j <= high[1]; ++j)
        for (int k = low[2]; k <= high[2]; ++k)
          if (leaves.empty() || leaves.back() != LeafCoordinates{i, j, k}) leaves.push_back({i, j, k});
  }
  return unique_leaves(std::move(leaves));
}

/// Those of them that hold places of the band: by the distance of their middles.
std::vector<LeafCoordinates> leaves_of_band(
    const std::vector<LeafCoordinates>& candidates, const Lattice& lattice,
    const std::function<std::vector<double>(const Points&)>& distance) {
  Points middles(3, static_cast<Eigen::Index>(candidates.size()));
  for (std::size_t i = 0; i < candidates.size(); ++i)
    middles.col(static_cast<Eigen::Index>(i)) =
        lattice.at(as_vector(first_node(candidates[i])) + Vector3::Constant((leaf_edge - 1) / 2.0));
  const std::vector<double> far = distance(middles);
  const double reach = (band_half_width + std::sqrt(3.0) * (leaf_edge - 1) / 2.0) * lattice.voxel_size;
  std::vector<LeafCoordinates> leaves;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (std::abs(far[i]) < reach) leaves.push_back(candidates[i]);
  return leaves;
}

Points nodes_of(const LeafCoordinates& leaf, const Lattice& lattice) {
  Points nodes(3, leaf_nodes);
  for (int n = 0; n < leaf_nodes; ++n) nodes.col(n) = lattice(moved(first_node(leaf), place_of_number(n)));
  return nodes;
}

void add_band_leaf(const LeafCoordinates& leaf, const double* distances, StoredGrid& grid) {
  LeafMask mask{};
  bool any = false;
  for (std::size_t n = 0; n < leaf_nodes; ++n)
    if (std::abs(distances[n]) < grid.background) {
      mask[n / 64] |= std::uint64_t{1} << (n % 64);
      any = true;
    }
  if (!any) return;
  grid.leaves.push_back(leaf);
  grid.active.push_back(mask);
  for (std::size_t n = 0; n < leaf_nodes; ++n)
    grid.values.push_back(std::clamp(static_cast<float>(distances[n]), -grid.background, grid.background));
}

constexpr std::array<LatticeCoordinates, 6> sides = {
    {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

/// The missing leaves of a box of leaves, found from its corner through missing ones.
class MissingLeaves {
 public:
  explicit MissingLeaves(const StoredGrid& grid) : grid_(grid), table_(grid.leaves) {
    low_ = high_ = grid.leaves.front();
    for (const LeafCoordinates& leaf : grid.leaves)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low_[axis] = std::min(low_[axis], leaf[axis] - 1);
        high_[axis] = std::max(high_[axis], leaf[axis] + 1);
      }
    seen_.assign(static_cast<std::size_t>(size(0)) * size(1) * size(2), 0);
  }

  std::vector<LeafCoordinates> enclosed() {
    flood(low_, nullptr);
    std::vector<LeafCoordinates> found;
    for (int i = low_[0]; i <= high_[0]; ++i)
      for (int j = low_[1]; j <= high_[1]; ++j)
        for (int k = low_[2]; k <= high_[2]; ++k) {
          const LeafCoordinates leaf{i, j, k};
          if (seen(leaf) || table_.find(leaf) != no_leaf) continue;
          std::vector<LeafCoordinates> pocket;
          if (flood(leaf, &pocket) < 0) found.insert(found.end(), pocket.begin(), pocket.end());
        }
    return unique_leaves(std::move(found));
  }

 private:
  int size(std::size_t axis) const { return high_[axis] - low_[axis] + 1; }
  char& seen(const LeafCoordinates& leaf) {
    return seen_[(static_cast<std::size_t>(leaf[0] - low_[0]) * size(1) + (leaf[1] - low_[1])) * size(2) +
                 (leaf[2] - low_[2])];
  }
  bool is_within(const LeafCoordinates& leaf) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (leaf[axis] < low_[axis] || leaf[axis] > high_[axis]) return false;
    return true;
  }

  /// Visits the missing leaves that hang together with `start`, and returns the sum of the signs of the
  /// stored nodes next to them.
  long flood(const LeafCoordinates& start, std::vector<LeafCoordinates>* visited) {
    long signs = 0;
    std::deque<LeafCoordinates> queue = {start};
    seen(start) = 1;
    while (!queue.empty()) {
      const LeafCoordinates leaf = queue.front();
      queue.pop_front();
      if (visited) visited->push_back(leaf);
      for (const LatticeCoordinates& side : sides) {
        const LeafCoordinates next = moved(leaf, side);
        if (!is_within(next)) continue;
        if (const int stored = table_.find(next); stored != no_leaf) {
          signs += sign_towards(stored, side);
        } else if (!seen(next)) {
          seen(next) = 1;
          queue.push_back(next);
        }
      }
    }
    return signs;
  }

  /// Of the node in the middle of the stored leaf's face that is nearest.
  int sign_towards(int stored, const LatticeCoordinates& side) const {
    LatticeCoordinates place{leaf_edge / 2, leaf_edge / 2, leaf_edge / 2};
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (side[axis] != 0) place[axis] = side[axis] > 0 ? 0 : leaf_edge - 1;
    const float value = grid_.values[static_cast<std::size_t>(stored) * leaf_nodes +
                                     static_cast<std::size_t>(number_of_place(place))];
    return value < 0 ? -1 : 1;
  }

  const StoredGrid& grid_;
  LeafTable table_;
  LeafCoordinates low_{}, high_{};
  std::vector<char> seen_;
};

}  // namespace

StoredGrid signed_band(const TriangleMesh& mesh,
                       const std::function<std::vector<double>(const Points&)>& distance) {
  StoredGrid grid;
  grid.components = 1;
  grid.grid_class = GridClass::level_set;
  grid.voxel_size = diagonal(mesh.vertices) / band_voxels_along_diagonal;
  grid.origin = bounding_box(mesh.vertices).min();
  grid.background = static_cast<float>(band_half_width * grid.voxel_size);
  const Lattice lattice{grid.origin, grid.voxel_size};
  const std::vector<LeafCoordinates> leaves =
      leaves_of_band(candidate_leaves(mesh, lattice), lattice, distance);
  for (std::size_t i = 0; i < leaves.size(); ++i)
    add_band_leaf(leaves[i], distance(nodes_of(leaves[i], lattice)).data(), grid);
  if (grid.leaves.empty()) throw InvalidInput("the model has no surface to measure distances from");
  return grid;
}

std::vector<LeafCoordinates> enclosed_leaves(const StoredGrid& band) {
  return MissingLeaves(band).enclosed();
}

Points surface_probes(const TriangleMesh& mesh) {
  const Eigen::Index faces = mesh.faces.cols(), all = faces + mesh.vertices.cols();
  const Eigen::Index step = std::max<Eigen::Index>(1, all / max_probes);
  Points probes(3, (all + step - 1) / step);
  for (Eigen::Index i = 0; i < probes.cols(); ++i) {
    const Eigen::Index at = i * step;
    if (at >= faces) {
      // A vertex of a face: others may be anywhere.
      probes.col(i) = mesh.vertices.col(mesh.faces(0, (at - faces) % faces));
      continue;
    }
    probes.col(i).setZero();
    for (const int vertex : mesh.faces.col(at)) probes.col(i) += mesh.vertices.col(vertex) / 3;
  }
  return probes;
}

}  // namespace bespoke
