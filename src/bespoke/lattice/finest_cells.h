#pragma once

#include <array>
#include <bitset>
#include <functional>

#include "bespoke/lattice/pyramid_index.h"

namespace bespoke {

/// Nodes along an edge of the block that the 8³ cells of an entry need, and nodes of the block.
inline constexpr int block_edge = leaf_edge + 1;
inline constexpr int block_nodes = block_edge * block_edge * block_edge;

/// Sum of the levels so far at the 9³ nodes of an entry, one array a component; node (i, j, k) at
/// (i·9 + j)·9 + k. Mesh units.
using NodeBlock = std::array<std::array<double, block_nodes>, 3>;

/// Which of the 8³ cells of an entry; cell (i, j, k) at (i·8 + j)·8 + k.
using CellMask = std::bitset<leaf_nodes>;

/// An entry of the pyramid with what the map is in its cells.
struct EntryCells {
  int level = 0;
  std::int32_t entry = 0;          ///< in PyramidIndex::levels[level]
  LeafCoordinates leaf{};          ///< of the entry
  const NodeBlock* sum = nullptr;  ///< u at the nodes; u is trilinear in every finest cell
  CellMask finest;                 ///< cells that no deeper level splits
};

/// Calls visit for the root entry and all entries below it that have finest cells, parents first, in lattice
/// order. The finest cells of all roots tile the places where u may be nonzero; each lies in one entry. A
/// cell is split when a deeper level is nonzero somewhere in it; its parts that the deeper level leaves alone
/// are finest cells of the deeper level's size.
void visit_finest_cells(const PyramidIndex& index, std::size_t root,
                        const std::function<void(const EntryCells&)>& visit);

/// The same below those entries only for which `enter(level, leaf)` is true.
void visit_finest_cells(const PyramidIndex& index, std::size_t root,
                        const std::function<bool(int level, const LeafCoordinates& leaf)>& enter,
                        const std::function<void(const EntryCells&)>& visit);

/// The upper half (octant bit set) or lower half of a block along each axis, interpolated onto nodes of half
/// the size.
void refine_block(const NodeBlock& coarse, int octant, NodeBlock& fine);

}  // namespace bespoke
