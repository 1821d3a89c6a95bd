#include "bespoke/volume/leaf_table.h"

#include <bit>

namespace bespoke {

LeafTable::LeafTable(const std::vector<LeafCoordinates>& leaves)
    : slots_(std::bit_ceil(2 * leaves.size() + 2)), mask_(slots_.size() - 1) {
  for (std::size_t position = 0; position < leaves.size(); ++position) {
    std::size_t slot = hash(leaves[position]) & mask_;
    while (slots_[slot].position != no_leaf) slot = (slot + 1) & mask_;
    slots_[slot] = {leaves[position], static_cast<std::int32_t>(position)};
  }
}

}  // namespace bespoke
