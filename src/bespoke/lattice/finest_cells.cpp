#include "bespoke/lattice/finest_cells.h"

#include <memory>
#include <vector>

namespace bespoke {
namespace {

// Which leaves around an entry exist, from the pointers alone.
std::array<bool, 8> present_blocks(const PyramidEntry& entry) {
  std::array<bool, 8> present;
  for (int octant = 0; octant < 8; ++octant) present[octant] = entry.blocks[octant] != absent_leaf();
  return present;
}

// Cells with a corner in a leaf: all of them where the entry is a leaf, else those at faces towards one.
CellMask nonzero_cells(const PyramidEntry& entry) {
  const std::array<bool, 8> present = present_blocks(entry);
  CellMask cells;
  if (present[0]) return cells.set();
  for (int i = 0; i < leaf_edge; ++i)
    for (int j = 0; j < leaf_edge; ++j)
      for (int k = 0; k < leaf_edge; ++k) {
        const int reached =
            (i == leaf_edge - 1 ? 4 : 0) | (j == leaf_edge - 1 ? 2 : 0) | (k == leaf_edge - 1);
        for (int octant = 1; octant < 8; ++octant)
          if ((octant & reached) == octant && present[octant]) cells.set((i * leaf_edge + j) * leaf_edge + k);
      }
  return cells;
}

// Bit (i·4 + j)·4 + k: some cell of the 2³ group at cell (2i, 2j, 2k) is set.
std::bitset<64> occupied_groups(const CellMask& cells) {
  std::bitset<64> groups;
  for (int i = 0; i < leaf_edge; ++i)
    for (int j = 0; j < leaf_edge; ++j)
      for (int k = 0; k < leaf_edge; ++k)
        if (cells[(i * leaf_edge + j) * leaf_edge + k]) groups.set((i / 2 * 4 + j / 2) * 4 + k / 2);
  return groups;
}

CellMask cells_of_groups(const std::bitset<64>& groups) {
  CellMask cells;
  for (int i = 0; i < leaf_edge; ++i)
    for (int j = 0; j < leaf_edge; ++j)
      for (int k = 0; k < leaf_edge; ++k)
        if (groups[(i / 2 * 4 + j / 2) * 4 + k / 2]) cells.set((i * leaf_edge + j) * leaf_edge + k);
  return cells;
}

// The cells of an octant, one a group of the octant's entry.
CellMask split_cells(int octant, const std::bitset<64>& groups) {
  CellMask cells;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k)
        if (groups[(i * 4 + j) * 4 + k])
          cells.set(((4 * (octant >> 2 & 1) + i) * leaf_edge + 4 * (octant >> 1 & 1) + j) * leaf_edge +
                    4 * (octant & 1) + k);
  return cells;
}

void add_leaves(const PyramidEntry& entry, NodeBlock& sum) {
  int node = 0;
  for (int i = 0; i < block_edge; ++i)
    for (int j = 0; j < block_edge; ++j)
      for (int k = 0; k < block_edge; ++k, ++node) {
        const float* value =
            entry.blocks[(i >> 3) << 2 | (j >> 3) << 1 | k >> 3] + node_offset(i & 7, j & 7, k & 7);
        for (int c = 0; c < 3; ++c) sum[c][node] += value[c];
      }
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
    std::array<std::bitset<64>, 8> groups;
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

void refine_block(const NodeBlock& coarse, int octant, NodeBlock& fine) {
  constexpr int plane = block_edge * block_edge;
  const int first = 4 * ((octant >> 2 & 1) * plane + (octant >> 1 & 1) * block_edge + (octant & 1));
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
