#include "bespoke/lattice/leaf.h"

#include <gtest/gtest.h>

#include <set>

#include "bespoke/lattice/lattice.h"

namespace bespoke {
namespace {

// Nodes on both sides of zero.
std::vector<LatticeCoordinates> some_nodes() {
  std::vector<LatticeCoordinates> nodes;
  for (const int i : {-17, -8, -1, 0, 7, 8})
    for (const int j : {-9, 3, 15})
      for (const int k : {-16, -2, 100}) nodes.push_back({i, j, k});
  return nodes;
}

TEST(Leaf, HoldsEightNodesAlongEachAxisFromItsFirst) {
  for (const LatticeCoordinates& node : some_nodes()) {
    const LatticeCoordinates place = place_in_leaf(node);
    EXPECT_EQ(moved(first_node(leaf_of(node)), place), node);
    for (const int along : place) EXPECT_TRUE(along >= 0 && along < leaf_edge);
  }
}

TEST(Leaf, NumbersItsPlacesInLexicographicOrder) {
  for (int n = 0; n < leaf_nodes; ++n) {
    EXPECT_EQ(number_of_place(place_of_number(n)), n);
    if (n == 0) continue;
    EXPECT_LT(place_of_number(n - 1), place_of_number(n));
  }
}

TEST(Leaf, IsCoveredByItsEightChildren) {
  for (const LeafCoordinates& leaf : some_nodes())
    for (int octant = 0; octant < 8; ++octant) {
      const LeafCoordinates child = child_of(leaf, octant);
      EXPECT_EQ(parent_of(child), leaf);
      EXPECT_EQ(octant_in_parent(child), octant);
    }
}

// Node 2 i of the finer level lies where node i does: the finer leaf there is the child that covers the cell.
TEST(Leaf, OctantOfACellIsThatOfTheFinerLeafThere) {
  for (const LatticeCoordinates& cell : some_nodes()) {
    const LatticeCoordinates fine = {2 * cell[0], 2 * cell[1], 2 * cell[2]};
    EXPECT_EQ(child_of(leaf_of(cell), octant_of_cell(cell)), leaf_of(fine));
    EXPECT_EQ(octant_of_cell(place_in_leaf(cell)), octant_of_cell(cell));
  }
  for (int octant = 0; octant < 8; ++octant) EXPECT_EQ(octant_of_cell(first_place_of_octant(octant)), octant);
}

TEST(Leaf, BlockOfItsCellsReachesTheUpperNeighbours) {
  const LeafCoordinates leaf = {-1, 0, 3};
  for (int n = 0; n < block_nodes; ++n) {
    const LatticeCoordinates place = place_in_block(n);
    EXPECT_EQ(number_in_block(place), n);
    EXPECT_EQ(moved(leaf, corner_step(leaf_of_block(place))), leaf_of(moved(first_node(leaf), place)));
  }
}

TEST(Leaf, CellReachesTheLeavesThatHoldItsCorners) {
  for (int n = 0; n < leaf_nodes; ++n) {
    std::set<int> reached;
    for (int corner = 0; corner < 8; ++corner)
      reached.insert(leaf_of_block(moved(place_of_number(n), corner_step(corner))));
    for (int leaf = 0; leaf < 8; ++leaf)
      EXPECT_EQ(cell_reaches(place_of_number(n), leaf), reached.count(leaf) > 0);
  }
}

TEST(Leaf, HasTwentySixNeighboursAndItself) {
  std::set<LatticeCoordinates> steps;
  for (int side = 0; side < neighbour_steps; ++side) {
    for (const int along : neighbour_step(side)) EXPECT_LE(along * along, 1);
    steps.insert(neighbour_step(side));
  }
  EXPECT_EQ(steps.size(), 27u);
}

TEST(Lattice, FindsTheCellOfEveryPlaceInIt) {
  const Lattice lattice{Vector3(0.5, -2, 1), 0.25};
  for (const LatticeCoordinates& node : some_nodes()) {
    EXPECT_EQ(lattice.cell_of(lattice(node)), node);
    EXPECT_EQ(lattice.cell_of(lattice.at(as_vector(node) + Vector3::Constant(0.99))), node);
  }
}

}  // namespace
}  // namespace bespoke
