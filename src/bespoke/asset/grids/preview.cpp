#include "bespoke/asset/grids/preview.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr double nodes_along_longest_side = 64;

// Keeps node coordinates far inside an int.
constexpr double largest_leaf_coordinate = 1 << 26;

/// Whole leaves that cover a box.
struct LeafRange {
  LeafCoordinates low;
  LeafCoordinates count;

  int nodes(int axis) const { return count[axis] * leaf_edge; }
  Eigen::Index node_count() const { return Eigen::Index{1} * nodes(0) * nodes(1) * nodes(2); }
  Eigen::Index node(int i, int j, int k) const { return (Eigen::Index{i} * nodes(1) + j) * nodes(2) + k; }
};

void extend_by_leaves(const Pyramid& pyramid, Box& box) {
  for (const PyramidLevel& level : pyramid.levels) {
    const Lattice lattice{pyramid.origin, level.voxel_size};
    constexpr int last = leaf_edge - 1;
    for (const LeafCoordinates& leaf : level.leaves) {
      box.extend(lattice(first_node(leaf)));
      box.extend(lattice(moved(first_node(leaf), {last, last, last})));
    }
  }
}

Box domain(const Asset& asset, Box box) {
  box.min().array() -= asset.record.lambda;
  box.max().array() += asset.record.lambda;
  for (const MapStep& step : asset.steps) extend_by_leaves(step.pyramid, box);
  return box;
}

/// A power of two times the pyramid's coarsest, so that every cell of the (first) pyramid lies in one cell of
/// the preview.
double preview_voxel_size(const Pyramid& pyramid, double longest_side) {
  const double wanted = longest_side / nodes_along_longest_side;
  if (pyramid.levels.empty()) return wanted;
  const double coarsest = pyramid.levels.front().voxel_size;
  return std::ldexp(coarsest, std::max(0, static_cast<int>(std::ceil(std::log2(wanted / coarsest)))));
}

LeafRange leaf_range(const Box& box, const Vector3& origin, double voxel_size) {
  LeafRange leaves;
  for (int axis = 0; axis < 3; ++axis) {
    const double leaf = voxel_size * leaf_edge;
    const double low = std::floor((box.min()[axis] - origin[axis]) / leaf);
    // One node of the next leaf closes the last cell.
    const double high = std::floor(std::ceil((box.max()[axis] - origin[axis]) / voxel_size) / leaf_edge);
    if (!(low > -largest_leaf_coordinate && high < largest_leaf_coordinate))
      throw InvalidInput("the map lies too far from its lattice's origin for voxels of " +
                         std::to_string(voxel_size));
    leaves.low[axis] = static_cast<int>(low);
    leaves.count[axis] = static_cast<int>(high - low) + 1;
  }
  return leaves;
}

template <class Body>
void for_each_node(const LatticeCoordinates& count, const Body& body) {
  for (int i = 0; i < count[0]; ++i)
    for (int j = 0; j < count[1]; ++j)
      for (int k = 0; k < count[2]; ++k) body(i, j, k);
}

/// Nodes of the box, moved by `shift` voxels along each axis.
Points lattice_points(const LeafRange& leaves, const Lattice& lattice, double shift) {
  Points points(3, leaves.node_count());
  const LatticeCoordinates first = first_node(leaves.low);
  for_each_node({leaves.nodes(0), leaves.nodes(1), leaves.nodes(2)}, [&](int i, int j, int k) {
    points.col(leaves.node(i, j, k)) =
        lattice.at(as_vector(moved(first, {i, j, k})) + Vector3::Constant(shift));
  });
  return points;
}

Points displacement_at(const Asset& asset, const ElasticChain& baked, const Points& x) {
  return asset.target_from_source * baked(x) - x;
}

Statistics preview_error(const LeafRange& leaves, const Points& nodes, const Points& centers) {
  std::vector<double> errors;
  errors.reserve(static_cast<std::size_t>(leaves.node_count()));
  for_each_node({leaves.nodes(0) - 1, leaves.nodes(1) - 1, leaves.nodes(2) - 1}, [&](int i, int j, int k) {
    Vector3 mean = Vector3::Zero();
    for (int corner = 0; corner < 8; ++corner) {
      const LatticeCoordinates node = moved({i, j, k}, corner_step(corner));
      mean += nodes.col(leaves.node(node[0], node[1], node[2])) / 8;
    }
    errors.push_back((mean - centers.col(leaves.node(i, j, k))).norm());
  });
  return summarize(std::move(errors));
}

void pack(const LeafRange& leaves, const Points& values, StoredGrid& grid) {
  for_each_node(leaves.count, [&](int a, int b, int c) {
    grid.leaves.push_back(moved(leaves.low, {a, b, c}));
    for_each_node({leaf_edge, leaf_edge, leaf_edge}, [&](int i, int j, int k) {
      const Eigen::Index node = leaves.node(a * leaf_edge + i, b * leaf_edge + j, c * leaf_edge + k);
      for (int axis = 0; axis < 3; ++axis) grid.values.push_back(static_cast<float>(values(axis, node)));
    });
  });
}

}  // namespace

PreviewGrids::PreviewGrids(std::vector<StoredGrid> grids) : grids_(std::move(grids)) {
  constexpr std::array<std::pair<const char*, int>, 5> expected = {{{displacement_name, 3},
                                                                    {source_distance_name, 1},
                                                                    {jacobian_name, 1},
                                                                    {target_distance_name, 1},
                                                                    {source_side_name, 1}}};
  if (grids_.size() < required || grids_.size() > expected.size())
    throw InvalidInput("there are not three preview grids");
  for (std::size_t i = 0; i < grids_.size(); ++i) {
    require_valid(grids_[i]);
    if (grids_[i].half) throw InvalidInput("grid " + grids_[i].name + " is of half precision");
    if (grids_[i].name != expected[i].first || grids_[i].components != expected[i].second)
      throw InvalidInput("grid " + grids_[i].name + " stands in the place of " + expected[i].first);
    const bool is_distance = grids_[i].components == 1 && grids_[i].name != jacobian_name;
    if ((grids_[i].grid_class == GridClass::level_set) != is_distance)
      throw InvalidInput("grid " + grids_[i].name + " has the wrong class");
  }
}

StoredGrid displacement_preview(const Asset& asset, const ElasticChain& baked, const Box& source_box) {
  const Box box = domain(asset, source_box);
  StoredGrid grid;
  grid.name = displacement_name;
  const Pyramid& pyramid = asset.steps.front().pyramid;
  grid.voxel_size = preview_voxel_size(pyramid, box.sizes().maxCoeff());
  grid.origin = pyramid.levels.empty() ? box.min() : pyramid.origin;
  const LeafRange leaves = leaf_range(box, grid.origin, grid.voxel_size);
  const Lattice lattice{grid.origin, grid.voxel_size};
  const Points nodes =
      displacement_at(asset, baked, lattice_points(leaves, lattice, 0)).cast<float>().cast<double>();
  const Points centers = displacement_at(asset, baked, lattice_points(leaves, lattice, 0.5));
  pack(leaves, nodes, grid);
  const Statistics error = preview_error(leaves, nodes, centers);
  grid.metadata["bespoke:meaning"] = std::string(
      "Psi(1)(x) - x at x in the source frame: a coarse preview of the exact map in u_0, u_1, ...");
  grid.metadata["bespoke:unit"] = asset.record.unit;
  grid.metadata["bespoke:error_max"] = error.max;
  grid.metadata["bespoke:error_p99"] = error.p99;
  return grid;
}

}  // namespace bespoke
