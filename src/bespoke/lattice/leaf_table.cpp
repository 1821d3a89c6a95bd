#include "bespoke/lattice/leaf_table.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace bespoke {

std::vector<LeafCoordinates> unique_leaves(std::vector<LeafCoordinates> leaves) {
  std::sort(leaves.begin(), leaves.end());
  leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
  return leaves;
}

LeafTable::LeafTable(const std::vector<LeafCoordinates>& leaves)
    : slots_(std::bit_ceil(2 * leaves.size() + 2)), mask_(slots_.size() - 1) {
  for (std::size_t position = 0; position < leaves.size(); ++position)
    insert(leaves[position], static_cast<std::int32_t>(position));
}

void LeafTable::insert(const LeafCoordinates& leaf, std::int32_t position) {
  if (2 * (size_ + 1) > slots_.size()) {
    std::vector<Slot> old(2 * slots_.size());
    std::swap(old, slots_);
    mask_ = slots_.size() - 1;
    size_ = 0;
    for (const Slot& slot : old)
      if (slot.position != no_leaf) insert(slot.leaf, slot.position);
  }
  std::size_t slot = hash(leaf) & mask_;
  while (slots_[slot].position != no_leaf) slot = (slot + 1) & mask_;
  slots_[slot] = {leaf, position};
  ++size_;
}

}  // namespace bespoke
