#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "bespoke/asset/grids/preview.h"
#include "bespoke/certificate/jacobian_bound.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/lattice/finest_cells.h"
#include "bespoke/lattice/leaf_table.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Roots whose bounds are held in memory at a time.
constexpr std::size_t roots_per_batch = 1024;

// Some ninety roundings of a double: more than summing and interpolating twenty levels takes.
constexpr double rounding = 1e-14;

/// Per cell of a level 0 entry, in the order of CellMask: least bound of the finest cells in it, infinite for
/// none.
using RootBounds = std::array<double, leaf_nodes>;

// The cell that holds `cell` on a lattice so many levels up.
constexpr LatticeCoordinates halved(const LatticeCoordinates& cell, int times) {
  return {cell[0] >> times, cell[1] >> times, cell[2] >> times};
}

class RootBounder {
 public:
  RootBounder(const Pyramid& pyramid, const Matrix3& linear)
      : pyramid_(pyramid), index_(pyramid), linear_(linear), sum_error_(rounding * largest_sum(pyramid)) {}

  std::size_t roots() const { return index_.levels.empty() ? 0 : index_.levels.front().size(); }
  const LeafCoordinates& leaf(std::size_t root) const { return index_.levels.front()[root].leaf; }

  RootBounds bounds(std::size_t root) const {
    RootBounds least;
    least.fill(std::numeric_limits<double>::infinity());
    visit_finest_cells(index_, root, [&](const EntryCells& cells) { lower(cells, least); });
    return least;
  }

 private:
  void lower(const EntryCells& cells, RootBounds& least) const {
    const double scale = 1 / pyramid_.lattice(cells.level).voxel_size;
    JacobianBlock block;
    bound_block(*cells.sum, linear_, scale, rounding * linear_.cwiseAbs().maxCoeff() + scale * sum_error_,
                block);
    for (int cell = 0; cell < leaf_nodes; ++cell) {
      const auto number = static_cast<std::size_t>(cell);
      if (!cells.finest[number]) continue;
      const LatticeCoordinates fine = moved(first_node(cells.leaf), place_of_number(cell));
      double& bound =
          least[static_cast<std::size_t>(number_of_place(place_in_leaf(halved(fine, cells.level))))];
      bound = std::min(bound, block.lower_bound[number]);
    }
  }

  const Pyramid& pyramid_;
  PyramidIndex index_;
  Matrix3 linear_;
  double sum_error_;
};

/// Lower bounds per node of the preview's lattice.
class NodeBounds {
 public:
  NodeBounds(const StoredGrid& lattice, double outside)
      : leaves_(lattice.leaves), bounds_(lattice.leaves.size() * leaf_nodes, outside) {}

  /// `cell` in cells of the preview.
  void lower(const LatticeCoordinates& cell, double bound) {
    for (int corner = 0; corner < 8; ++corner) {
      const LatticeCoordinates node = moved(cell, corner_step(corner));
      const int leaf = leaves_.find(leaf_of(node));
      if (leaf == no_leaf) continue;
      double& old = bounds_[static_cast<std::size_t>(leaf) * leaf_nodes +
                            static_cast<std::size_t>(number_of_place(place_in_leaf(node)))];
      old = std::min(old, bound);
    }
  }

  const std::vector<double>& bounds() const { return bounds_; }

 private:
  LeafTable leaves_;
  std::vector<double> bounds_;
};

/// `halvings`: how often a cell of the preview is halved to give one of level 0.
void lower_by_pyramid(const RootBounder& bounder, int halvings, NodeBounds& nodes) {
  std::vector<RootBounds> batch(std::min(roots_per_batch, bounder.roots()));
  for (std::size_t first = 0; first < bounder.roots(); first += roots_per_batch) {
    const std::size_t count = std::min(roots_per_batch, bounder.roots() - first);
    parallel_for(count, 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) batch[i] = bounder.bounds(first + i);
    });
    for (std::size_t i = 0; i < count; ++i) {
      const LeafCoordinates& leaf = bounder.leaf(first + i);
      for (int cell = 0; cell < leaf_nodes; ++cell) {
        const double bound = batch[i][static_cast<std::size_t>(cell)];
        if (std::isinf(bound)) continue;
        nodes.lower(halved(moved(first_node(leaf), place_of_number(cell)), halvings), bound);
      }
    }
  }
}

float rounded_down(double value) {
  const auto rounded = static_cast<float>(value);
  return rounded <= value ? rounded : std::nextafter(rounded, -std::numeric_limits<float>::infinity());
}

/// Lower bounds of det ∇ over the cells that touch each node.
std::vector<double> bounds_at_nodes(const BakedMap& baked, const StoredGrid& displacement) {
  const Pyramid& pyramid = baked.pyramid();
  NodeBounds nodes(displacement, baked.affine().linear.determinant());
  if (!pyramid.levels.empty())
    lower_by_pyramid(RootBounder(pyramid, baked.affine().linear),
                     std::ilogb(displacement.voxel_size / pyramid.levels.front().voxel_size), nodes);
  return nodes.bounds();
}

std::vector<double> determinants_at_nodes(const ElasticChain& baked, const StoredGrid& lattice) {
  Points nodes(3, static_cast<Eigen::Index>(lattice.leaves.size()) * leaf_nodes);
  Eigen::Index column = 0;
  const Lattice places{lattice.origin, lattice.voxel_size};
  for (const LeafCoordinates& leaf : lattice.leaves)
    for (int node = 0; node < leaf_nodes; ++node)
      nodes.col(column++) = places(moved(first_node(leaf), place_of_number(node)));
  const Matrix3 linear = baked.affine().linear;
  const Points gradient = baked.displacement_gradient(nodes);
  std::vector<double> determinants;
  for (Eigen::Index i = 0; i < nodes.cols(); ++i)
    determinants.push_back((linear + gradient.middleCols<3>(3 * i)).determinant());
  return determinants;
}

}  // namespace

StoredGrid jacobian_preview(const ElasticChain& baked, const StoredGrid& displacement) {
  const auto* only =
      baked.steps().size() == 1 ? dynamic_cast<const BakedMap*>(baked.steps().front().get()) : nullptr;
  StoredGrid grid;
  grid.name = jacobian_name;
  grid.components = 1;
  grid.voxel_size = displacement.voxel_size;
  grid.origin = displacement.origin;
  grid.leaves = displacement.leaves;
  for (const double value :
       only ? bounds_at_nodes(*only, displacement) : determinants_at_nodes(baked, displacement))
    grid.values.push_back(rounded_down(value - 1));
  grid.metadata["bespoke:meaning"] =
      std::string(only ? "lower bound of det grad E over the cells that touch the node, minus 1"
                       : "det grad E of the whole chain at the node, minus 1");
  return grid;
}

}  // namespace bespoke
