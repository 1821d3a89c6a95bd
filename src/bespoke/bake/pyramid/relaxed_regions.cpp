#include "bespoke/bake/pyramid/relaxed_regions.h"

#include <algorithm>
#include <cmath>

#include "bespoke/lattice/leaf_table.h"
#include "bespoke/mesh/disjoint_sets.h"

namespace bespoke {
namespace {

LeafCoordinates coarsest_above(const RefusedOctant& octant) {
  LeafCoordinates leaf = octant.leaf;
  for (std::size_t level = octant.level; level > 0; --level) leaf = parent_of(leaf);
  return leaf;
}

Box box_of(const Lattice& coarsest, const RefusedOctant& octant) {
  const Lattice lattice{coarsest.origin, std::ldexp(coarsest.voxel_size, -static_cast<int>(octant.level))};
  const LatticeCoordinates first = first_node(octant.leaf);
  return {lattice(first), lattice(moved(first, {leaf_edge, leaf_edge, leaf_edge}))};
}

}  // namespace

std::vector<RelaxedRegion> relaxed_regions(const Lattice& coarsest,
                                           const std::vector<RefusedOctant>& refused) {
  std::vector<LeafCoordinates> leaves;
  for (const RefusedOctant& octant : refused) leaves.push_back(coarsest_above(octant));
  leaves = unique_leaves(std::move(leaves));
  const LeafTable table(leaves);
  DisjointSets sets(static_cast<int>(leaves.size()));
  for (std::size_t leaf = 0; leaf < leaves.size(); ++leaf)
    for (int side = 0; side < neighbour_steps; ++side) {
      const int neighbour = table.find(moved(leaves[leaf], neighbour_step(side)));
      if (neighbour != no_leaf) sets.join(static_cast<int>(leaf), neighbour);
    }
  std::vector<RelaxedRegion> by_set(leaves.size());
  for (const RefusedOctant& octant : refused) {
    const int set = sets.least(table.find(coarsest_above(octant)));
    RelaxedRegion& region = by_set[static_cast<std::size_t>(set)];
    region.box.extend(box_of(coarsest, octant));
    region.error = std::max(region.error, octant.error);
  }
  std::erase_if(by_set, [](const RelaxedRegion& region) { return region.box.isEmpty(); });
  std::stable_sort(by_set.begin(), by_set.end(),
                   [](const RelaxedRegion& a, const RelaxedRegion& b) { return a.error > b.error; });
  return by_set;
}

}  // namespace bespoke
