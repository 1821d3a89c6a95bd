#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "bespoke/asset/preview.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Blocks of cells whose bounds are held in memory at a time.
constexpr std::size_t blocks_per_batch = 1024;

// Covers the rounding of 64 triple products of values near 1.
constexpr double rounding_slack = 1e-13;

/// 8³ cells; cell (i, j, k) of a block has its lower corner at node (i, j, k) of the leaf position.
using CellSet = std::bitset<leaf_nodes>;
using CellBlocks = std::map<LeafCoordinates, CellSet>;

constexpr std::size_t cell_index(int i, int j, int k) {
  return static_cast<std::size_t>((i * leaf_edge + j) * leaf_edge + k);
}

/// Cells that touch a node of a leaf: those of its own position and, of the lower neighbours, the last ones.
CellBlocks touched_cells(const PyramidLevel& level) {
  CellBlocks blocks;
  for (const LeafCoordinates& leaf : level.leaves) {
    for (int neighbour = 0; neighbour < 8; ++neighbour) {
      const std::array<int, 3> back = {neighbour >> 2, neighbour >> 1 & 1, neighbour & 1};
      CellSet& cells = blocks[{leaf[0] - back[0], leaf[1] - back[1], leaf[2] - back[2]}];
      for (int i = back[0] * (leaf_edge - 1); i < leaf_edge; ++i)
        for (int j = back[1] * (leaf_edge - 1); j < leaf_edge; ++j)
          for (int k = back[2] * (leaf_edge - 1); k < leaf_edge; ++k) cells.set(cell_index(i, j, k));
    }
  }
  return blocks;
}

template <class Body>
void for_each_cell(const CellSet& cells, const Body& body) {
  for (int i = 0; i < leaf_edge; ++i)
    for (int j = 0; j < leaf_edge; ++j)
      for (int k = 0; k < leaf_edge; ++k)
        if (cells.test(cell_index(i, j, k))) body(std::array<int, 3>{i, j, k});
}

CellBlocks parents(const CellBlocks& fine) {
  CellBlocks coarse;
  for (const auto& [leaf, cells] : fine) {
    CellSet& parent = coarse[{leaf[0] >> 1, leaf[1] >> 1, leaf[2] >> 1}];
    const std::array<int, 3> half = {(leaf[0] & 1) * 4, (leaf[1] & 1) * 4, (leaf[2] & 1) * 4};
    for_each_cell(cells, [&](const std::array<int, 3>& cell) {
      parent.set(cell_index(half[0] + cell[0] / 2, half[1] + cell[1] / 2, half[2] + cell[2] / 2));
    });
  }
  return coarse;
}

void add_children(const CellBlocks& coarse, CellBlocks& fine) {
  for (const auto& [leaf, cells] : coarse) {
    for_each_cell(cells, [&, leaf = leaf](const std::array<int, 3>& cell) {
      CellSet& block =
          fine[{2 * leaf[0] + cell[0] / 4, 2 * leaf[1] + cell[1] / 4, 2 * leaf[2] + cell[2] / 4}];
      for (int child = 0; child < 8; ++child)
        block.set(cell_index(2 * (cell[0] % 4) + (child >> 2), 2 * (cell[1] % 4) + (child >> 1 & 1),
                             2 * (cell[2] % 4) + (child & 1)));
    });
  }
}

/// Per level, the cells that no finer level divides: there the sum is trilinear.
std::vector<CellBlocks> finest_cells(const Pyramid& pyramid) {
  std::vector<CellBlocks> finest;
  CellBlocks divided_above;
  for (std::size_t level = 0; level < pyramid.levels.size(); ++level) {
    CellBlocks cells = touched_cells(pyramid.levels[level]);
    add_children(divided_above, cells);
    divided_above.clear();
    if (level + 1 < pyramid.levels.size()) divided_above = parents(touched_cells(pyramid.levels[level + 1]));
    for (const auto& [leaf, divided] : divided_above) cells[leaf] &= ~divided;
    finest.push_back(std::move(cells));
  }
  return finest;
}

/// Least of the 27 Bézier coefficients of det ∇E over a trilinear cell. `corner` holds u at its corners,
/// numbered 4 i + 2 j + k. The columns of ∇E are bilinear in the two other coordinates; their triple product
/// has degree 2 in each, with the coefficients that multiplying Bernstein polynomials gives.
double determinant_bound(const std::array<Vector3, 8>& corner, const Matrix3& linear, double voxel_size) {
  std::array<std::array<Vector3, 4>, 3> columns;
  for (int side = 0; side < 4; ++side) {
    const int first = side >> 1, second = side & 1;
    columns[0][side] =
        (corner[4 + 2 * first + second] - corner[2 * first + second]) / voxel_size + linear.col(0);
    columns[1][side] =
        (corner[4 * first + 2 + second] - corner[4 * first + second]) / voxel_size + linear.col(1);
    columns[2][side] =
        (corner[4 * first + 2 * second + 1] - corner[4 * first + 2 * second]) / voxel_size + linear.col(2);
  }
  std::array<double, 27> sums{};
  for (int a = 0; a < 4; ++a) {    // (y, z) of column 0
    for (int b = 0; b < 4; ++b) {  // (x, z) of column 1
      const Vector3 cross = columns[0][a].cross(columns[1][b]);
      for (int c = 0; c < 4; ++c) {  // (x, y) of column 2
        const int x = (b >> 1) + (c >> 1), y = (a >> 1) + (c & 1), z = (a & 1) + (b & 1);
        sums[static_cast<std::size_t>(9 * x + 3 * y + z)] += cross.dot(columns[2][c]);
      }
    }
  }
  double least = std::numeric_limits<double>::infinity();
  double largest = 0;
  for (int coefficient = 0; coefficient < 27; ++coefficient) {
    const int ones = (coefficient / 9 == 1) + (coefficient / 3 % 3 == 1) + (coefficient % 3 == 1);
    const double value = sums[static_cast<std::size_t>(coefficient)] / (1 << ones);
    least = std::min(least, value);
    largest = std::max(largest, std::abs(value));
  }
  return least - rounding_slack * (1 + largest);
}

/// Bounds of a block's cells; infinite for the others.
std::array<double, leaf_nodes> block_bounds(const BakedMap& baked, double voxel_size,
                                            const LeafCoordinates& leaf, const CellSet& cells) {
  constexpr int edge = leaf_edge + 1;
  Points nodes(3, edge * edge * edge);
  for (int i = 0; i < edge; ++i)
    for (int j = 0; j < edge; ++j)
      for (int k = 0; k < edge; ++k)
        nodes.col((i * edge + j) * edge + k) =
            baked.pyramid().origin +
            voxel_size * Vector3(leaf[0] * leaf_edge + i, leaf[1] * leaf_edge + j, leaf[2] * leaf_edge + k);
  const Points u = baked.displacement(nodes);
  const Matrix3 linear = baked.affine().linear;
  std::array<double, leaf_nodes> bounds;
  bounds.fill(std::numeric_limits<double>::infinity());
  for_each_cell(cells, [&](const std::array<int, 3>& cell) {
    std::array<Vector3, 8> corner;
    for (int c = 0; c < 8; ++c)
      corner[static_cast<std::size_t>(c)] =
          u.col(((cell[0] + (c >> 2)) * edge + cell[1] + (c >> 1 & 1)) * edge + cell[2] + (c & 1));
    bounds[cell_index(cell[0], cell[1], cell[2])] = determinant_bound(corner, linear, voxel_size);
  });
  return bounds;
}

/// Lower bounds per node of the preview's lattice.
class NodeBounds {
 public:
  NodeBounds(const StoredGrid& lattice, double outside)
      : bounds_(lattice.leaves.size() * leaf_nodes, outside) {
    for (std::size_t i = 0; i < lattice.leaves.size(); ++i) leaves_[lattice.leaves[i]] = i;
  }

  /// `cell` in cells of the preview.
  void lower(const std::array<int, 3>& cell, double bound) {
    for (int c = 0; c < 8; ++c) {
      const std::array<int, 3> node = {cell[0] + (c >> 2), cell[1] + (c >> 1 & 1), cell[2] + (c & 1)};
      const auto leaf = leaves_.find({node[0] >> 3, node[1] >> 3, node[2] >> 3});
      if (leaf == leaves_.end()) continue;
      double& old = bounds_[leaf->second * leaf_nodes + cell_index(node[0] & 7, node[1] & 7, node[2] & 7)];
      old = std::min(old, bound);
    }
  }

  const std::vector<double>& bounds() const { return bounds_; }

 private:
  std::map<LeafCoordinates, std::size_t> leaves_;
  std::vector<double> bounds_;
};

void lower_by_level(const BakedMap& baked, double voxel_size, int cells_per_preview_cell,
                    const CellBlocks& cells, NodeBounds& nodes) {
  const std::vector<std::pair<LeafCoordinates, CellSet>> blocks(cells.begin(), cells.end());
  std::vector<std::array<double, leaf_nodes>> bounds(std::min(blocks_per_batch, blocks.size()));
  for (std::size_t first = 0; first < blocks.size(); first += blocks_per_batch) {
    const std::size_t count = std::min(blocks_per_batch, blocks.size() - first);
    parallel_for(count, 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (blocks[first + i].second.any())
          bounds[i] = block_bounds(baked, voxel_size, blocks[first + i].first, blocks[first + i].second);
    });
    for (std::size_t i = 0; i < count; ++i) {
      const auto& [leaf, set] = blocks[first + i];
      for_each_cell(set, [&, leaf = leaf](const std::array<int, 3>& cell) {
        std::array<int, 3> preview_cell;
        for (int axis = 0; axis < 3; ++axis)
          preview_cell[axis] = static_cast<int>(
              std::floor(static_cast<double>(leaf[axis] * leaf_edge + cell[axis]) / cells_per_preview_cell));
        nodes.lower(preview_cell, bounds[i][cell_index(cell[0], cell[1], cell[2])]);
      });
    }
  }
}

}  // namespace

StoredGrid jacobian_preview(const BakedMap& baked, const StoredGrid& displacement) {
  NodeBounds nodes(displacement, baked.affine().linear.determinant());
  const std::vector<CellBlocks> finest = finest_cells(baked.pyramid());
  for (std::size_t level = 0; level < finest.size(); ++level) {
    const double voxel_size = baked.pyramid().levels[level].voxel_size;
    lower_by_level(baked, voxel_size, static_cast<int>(std::lround(displacement.voxel_size / voxel_size)),
                   finest[level], nodes);
  }
  StoredGrid grid;
  grid.name = jacobian_name;
  grid.components = 1;
  grid.voxel_size = displacement.voxel_size;
  grid.origin = displacement.origin;
  grid.leaves = displacement.leaves;
  for (const double bound : nodes.bounds()) {
    const auto rounded = static_cast<float>(bound - 1);
    grid.values.push_back(
        rounded <= bound - 1 ? rounded : std::nextafter(rounded, -std::numeric_limits<float>::infinity()));
  }
  grid.metadata["bespoke:meaning"] =
      std::string("lower bound of det grad E over the cells that touch the node, minus 1");
  return grid;
}

}  // namespace bespoke
