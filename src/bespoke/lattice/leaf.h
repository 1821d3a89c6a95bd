#pragma once

#include <array>
#include <cstddef>

namespace bespoke {

/// A node or a cell (by its lower node) of a lattice; or a leaf, in units of leaves: leaf c holds the nodes
/// 8 c … 8 c + 7 along each axis, and the cells that start at them.
using LatticeCoordinates = std::array<int, 3>;
using LeafCoordinates = LatticeCoordinates;

/// Nodes along an edge of a leaf, nodes of a leaf, and floats of a leaf that holds vectors. The same leaves
/// as an OpenVDB tree's, so that storing copies them.
inline constexpr int leaf_edge = 8;
inline constexpr int leaf_nodes = leaf_edge * leaf_edge * leaf_edge;
inline constexpr int leaf_floats = 3 * leaf_nodes;

constexpr LatticeCoordinates moved(const LatticeCoordinates& from, const LatticeCoordinates& step) {
  return {from[0] + step[0], from[1] + step[1], from[2] + step[2]};
}

/// Step from the lower to corner 0 … 7 of a cell, of the octants of a leaf or of a 2³ block of leaves: bit 2
/// is x, bit 1 is y, bit 0 is z.
constexpr LatticeCoordinates corner_step(int corner) {
  return {corner >> 2 & 1, corner >> 1 & 1, corner & 1};
}

/// Steps 0 … 26 to the neighbours across faces, edges and corners; 13 stays.
inline constexpr int neighbour_steps = 27;
constexpr LatticeCoordinates neighbour_step(int side) {
  return {side / 9 - 1, side / 3 % 3 - 1, side % 3 - 1};
}

/// The leaf that holds a node, the node's place in it (0 … 7 along each axis), and the leaf's first node.
constexpr LeafCoordinates leaf_of(const LatticeCoordinates& node) {
  return {node[0] >> 3, node[1] >> 3, node[2] >> 3};
}
constexpr LatticeCoordinates place_in_leaf(const LatticeCoordinates& node) {
  return {node[0] & 7, node[1] & 7, node[2] & 7};
}
constexpr LatticeCoordinates first_node(const LeafCoordinates& leaf) {
  return {leaf_edge * leaf[0], leaf_edge * leaf[1], leaf_edge * leaf[2]};
}

/// Number 0 … 511 of a place in a leaf, in which values and masks are laid out, and back.
constexpr int number_of_place(const LatticeCoordinates& place) {
  return (place[0] * leaf_edge + place[1]) * leaf_edge + place[2];
}
constexpr LatticeCoordinates place_of_number(int number) {
  return {number >> 6, number >> 3 & 7, number & 7};
}

/// A leaf of the next finer level covers one octant of a leaf: 4³ of its cells.
constexpr LeafCoordinates child_of(const LeafCoordinates& leaf, int octant) {
  return {2 * leaf[0] + (octant >> 2 & 1), 2 * leaf[1] + (octant >> 1 & 1), 2 * leaf[2] + (octant & 1)};
}
constexpr LeafCoordinates parent_of(const LeafCoordinates& leaf) {
  return {leaf[0] >> 1, leaf[1] >> 1, leaf[2] >> 1};
}
/// Which octant of its parent a leaf covers, and in which octant of its leaf a cell lies.
constexpr int octant_in_parent(const LeafCoordinates& leaf) {
  return (leaf[0] & 1) << 2 | (leaf[1] & 1) << 1 | (leaf[2] & 1);
}
constexpr int octant_of_cell(const LatticeCoordinates& cell) {
  return (cell[0] & 4) | (cell[1] & 4) >> 1 | (cell[2] & 4) >> 2;
}
/// The place of an octant's first cell.
constexpr LatticeCoordinates first_place_of_octant(int octant) {
  return {octant & 4, (octant & 2) << 1, (octant & 1) << 2};
}

/// The 8³ cells of a leaf have 9³ nodes, which lie in it and its seven upper neighbours. Nodes along an edge
/// of that block, nodes of it, and the number of a place (0 … 8 along each axis) in it.
inline constexpr int block_edge = leaf_edge + 1;
inline constexpr int block_nodes = block_edge * block_edge * block_edge;
constexpr int number_in_block(const LatticeCoordinates& place) {
  return (place[0] * block_edge + place[1]) * block_edge + place[2];
}
constexpr LatticeCoordinates place_in_block(int number) {
  return {number / (block_edge * block_edge), number / block_edge % block_edge, number % block_edge};
}
/// Which of these eight leaves (by corner_step) holds a place of the block.
constexpr int leaf_of_block(const LatticeCoordinates& place) {
  return (place[0] >> 3) << 2 | (place[1] >> 3) << 1 | place[2] >> 3;
}
/// Whether one of them holds a corner of the cell at a place (0 … 7 along each axis).
constexpr bool cell_reaches(const LatticeCoordinates& place, int leaf) {
  return (leaf & ~leaf_of_block(moved(place, {1, 1, 1}))) == 0;
}

}  // namespace bespoke
