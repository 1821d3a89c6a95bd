#pragma once

#include "bespoke/lattice/leaf.h"

namespace bespoke {

/// Whether an octant of a leaf (4³ cells, 8³ nodes of the next level) needs a finer leaf is tested at one
/// node a cell.
inline constexpr int tested_nodes = 64;

/// An octant fails where the error exceeds this share of the tolerance: the largest error of a cell lies a
/// little above the one that is tested.
inline constexpr double test_margin = 0.8;

/// The node of cell `number` at which an octant is tested, in the next level's nodes: the cell's centre, or
/// the middle of a face or an edge, in turn, because harmonic displacements have no error at centres.
inline LatticeCoordinates tested_node(int number) {
  const LatticeCoordinates cell = {number / 16, number / 4 % 4, number % 4};
  const LatticeCoordinates middle = corner_step(1 + (cell[0] + 2 * cell[1] + 4 * cell[2]) % 7);
  return {2 * cell[0] + middle[0], 2 * cell[1] + middle[1], 2 * cell[2] + middle[2]};
}

}  // namespace bespoke
