#include "bespoke/lattice/finest_cells.h"

#include <memory>
#include <vector>

namespace bespoke {
namespace {

// Cells with a corner in a leaf: all of them where the entry is a leaf, else those at faces towards one.
CellMask nonzero_cells(const PyramidEntry& entry) {
  std::array<bool, 8> present;
  for (int block = 0; block < 8; ++block) present[block] = entry.blocks[block] != absent_leaf();
  CellMask cells;
  if (present[0]) return cells.set();
  for (int cell = 0; cell < leaf_nodes; ++cell)
    for (int block = 1; block < 8; ++block)
      if (present[block] && cell_reaches(place_of_number(cell), block))
        cells.set(static_cast<std::size_t>(cell));
  return cells;
}

// Which of the 4³ groups of 2³ cells, each one cell of the level above; group (i, j, k) at (i·4 + j)·4 + k.
using GroupMask = std::bitset<64>;

constexpr std::size_t group_of(const LatticeCoordinates& cell) {
  return static_cast<std::size_t>((cell[0] / 2 * 4 + cell[1] / 2) * 4 + cell[2] / 2);
}

GroupMask occupied_groups(const CellMask& cells) {
  GroupMask groups;
  for (int cell = 0; cell < leaf_nodes; ++cell)
    if (cells[static_cast<std::size_t>(cell)]) groups.set(group_of(place_of_number(cell)));
  return groups;
}

CellMask cells_of_groups(const GroupMask& groups) {
  CellMask cells;
  for (int cell = 0; cell < leaf_nodes; ++cell)
    if (groups[group_of(place_of_number(cell))]) cells.set(static_cast<std::size_t>(cell));
  return cells;
}

// The cells of an octant, one a group of the entry that covers the octant.
CellMask split_cells(int octant, const GroupMask& groups) {
  const LatticeCoordinates first = first_place_of_octant(octant);
  CellMask cells;
  for (int group = 0; group < 64; ++group)
    if (groups[static_cast<std::size_t>(group)])
      cells.set(
          static_cast<std::size_t>(number_of_place(moved(first, {group >> 4, group >> 2 & 3, group & 3}))));
  return cells;
}

using Enter = std::function<bool(int level, const LeafCoordinates& leaf)>;
using Visit = std::function<void(const EntryCells&)>;

class Visitor {
 public:
  /// An empty `enter` is true everywhere.
  Visitor(const PyramidIndex& index, const Enter& enter, const Visit& visit)
      : index_(index), enter_(enter), visit_(visit), blocks_(index.levels.size()) {
    for (auto& block : blocks_) block = std::make_unique<NodeBlock>();
  }

  void visit_root(std::size_t root) {
    for (auto& component : *blocks_[0]) component.fill(0);
    const PyramidEntry& entry = index_.levels[0][root];
    if (enter_ && !enter_(0, entry.leaf)) return;
    descend(0, static_cast<std::int32_t>(root), nonzero_cells(entry));
  }

 private:
  // `cells`: those of the entry that the level above is split into.
  void descend(int level, std::int32_t number, const CellMask& cells) {
    const PyramidEntry& entry = index_.levels[level][number];
    NodeBlock& sum = *blocks_[level];
    add_leaves(entry, sum);
    CellMask finest = cells;
    std::array<GroupMask, 8> groups;
    for (int octant = 0; octant < 8; ++octant) {
      if (entry.children[octant] == no_leaf) continue;
      groups[octant] = occupied_groups(nonzero_cells(index_.levels[level + 1][entry.children[octant]]));
      finest &= ~split_cells(octant, groups[octant]);
    }
    if (finest.any()) visit_({level, number, entry.leaf, &sum, finest});
    for (int octant = 0; octant < 8; ++octant) {
      if (entry.children[octant] == no_leaf) continue;
      if (enter_ && !enter_(level + 1, index_.levels[level + 1][entry.children[octant]].leaf)) continue;
      refine_block(sum, octant, *blocks_[level + 1]);
      descend(level + 1, entry.children[octant], cells_of_groups(groups[octant]));
    }
  }

  const PyramidIndex& index_;
  const Enter& enter_;
  const Visit& visit_;
  std::vector<std::unique_ptr<NodeBlock>> blocks_;  // of the entry being visited, one a level
};

}  // namespace

void visit_finest_cells(const PyramidIndex& index, std::size_t root, const Visit& visit) {
  Visitor(index, {}, visit).visit_root(root);
}

void visit_finest_cells(const PyramidIndex& index, std::size_t root, const Enter& enter, const Visit& visit) {
  Visitor(index, enter, visit).visit_root(root);
}

void add_leaves(const PyramidEntry& entry, NodeBlock& sum) {
  for (int node = 0; node < block_nodes; ++node) {
    const BlockValue from = block_values[node];
    const float* value = entry.blocks[from.leaf] + from.offset;
    for (int c = 0; c < 3; ++c) sum[c][node] += value[c];
  }
}

void refine_block(const NodeBlock& coarse, int octant, NodeBlock& fine) {
  constexpr int plane = block_edge * block_edge;
  const int first = number_in_block(first_place_of_octant(octant));
  for (int c = 0; c < 3; ++c) {
    const double* from = coarse[c].data() + first;
    double* to = fine[c].data();
    // Along one axis after the other: first the even nodes' lines, then the planes between them.
    for (int i = 0; i < block_edge; i += 2)
      for (int j = 0; j < block_edge; j += 2) {
        const double* line = from + i / 2 * plane + j / 2 * block_edge;
        double* out = to + i * plane + j * block_edge;
        for (int k = 0; k < 4; ++k) {
          out[2 * k] = line[k];
          out[2 * k + 1] = 0.5 * (line[k] + line[k + 1]);
        }
        out[8] = line[4];
      }
    for (int i = 0; i < block_edge; i += 2)
      for (int j = 1; j < block_edge; j += 2)
        for (int k = 0; k < block_edge; ++k) {
          double* out = to + i * plane + j * block_edge + k;
          *out = 0.5 * (out[-block_edge] + out[block_edge]);
        }
    for (int i = 1; i < block_edge; i += 2)
      for (int n = 0; n < plane; ++n) {
        double* out = to + i * plane + n;
        *out = 0.5 * (out[-plane] + out[plane]);
      }
  }
}

}  // namespace bespoke
