#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "bespoke/asset/grids/stored_grid.h"

namespace bespoke {

/// The leaves of an OpenVDB tree in lexicographic order.
template <class Tree>
std::vector<std::pair<LeafCoordinates, const typename Tree::LeafNodeType*>> sorted_leaves(const Tree& tree) {
  std::vector<std::pair<LeafCoordinates, const typename Tree::LeafNodeType*>> leaves;
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    const openvdb::Coord origin = leaf->origin();
    leaves.push_back({leaf_of({origin.x(), origin.y(), origin.z()}), leaf.getLeaf()});
  }
  std::sort(leaves.begin(), leaves.end());
  return leaves;
}

/// Which nodes of an OpenVDB leaf are active.
template <class Leaf>
LeafMask active_mask(const Leaf& leaf) {
  LeafMask mask;
  for (std::size_t word = 0; word < mask.size(); ++word)
    mask[word] = leaf.getValueMask().template getWord<openvdb::Index64>(static_cast<openvdb::Index>(word));
  return mask;
}

}  // namespace bespoke
