#pragma once

#include <array>
#include <bitset>
#include <functional>

#include "bespoke/lattice/pyramid_index.h"

namespace bespoke {

/// Sum of the levels so far at the 9³ nodes of an entry, one array a component; nodes by number_in_block.
/// Mesh units.
using NodeBlock = std::array<std::array<double, block_nodes>, 3>;

/// Where the value at a node of a block stands: in which of the eight leaves, and from which float of it.
struct BlockValue {
  int leaf = 0;
  int offset = 0;
};
inline constexpr std::array<BlockValue, block_nodes> block_values = [] {
  std::array<BlockValue, block_nodes> values{};
  for (int node = 0; node < block_nodes; ++node) {
    const LatticeCoordinates place = place_in_block(node);
    values[static_cast<std::size_t>(node)] = {leaf_of_block(place),
                                              3 * number_of_place(place_in_leaf(place))};
  }
  return values;
}();

/// Which of the 8³ cells of an entry, by number_of_place.
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

/// Adds the values of an entry's own level at its nodes.
void add_leaves(const PyramidEntry& entry, NodeBlock& sum);

/// The upper half (octant bit set) or lower half of a block along each axis, interpolated onto nodes of half
/// the size.
void refine_block(const NodeBlock& coarse, int octant, NodeBlock& fine);

}  // namespace bespoke
