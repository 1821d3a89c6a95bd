#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bespoke/lattice/leaf.h"

namespace bespoke {

/// In lexicographic order, each once.
std::vector<LeafCoordinates> unique_leaves(std::vector<LeafCoordinates> leaves);

/// What LeafTable::find returns for a leaf that is not in the list.
inline constexpr int no_leaf = -1;

/// Finds leaves of a list by their coordinates. Thread-safe to read.
class LeafTable {
 public:
  LeafTable() : LeafTable(std::vector<LeafCoordinates>{}) {}
  /// Each leaf once.
  explicit LeafTable(const std::vector<LeafCoordinates>& leaves);

  /// `leaf` must not be in the table yet.
  void insert(const LeafCoordinates& leaf, std::int32_t position);

  /// Position in the list, or no_leaf.
  int find(const LeafCoordinates& leaf) const {
    for (std::size_t slot = hash(leaf) & mask_;; slot = (slot + 1) & mask_) {
      const Slot& found = slots_[slot];
      if (found.position == no_leaf || found.leaf == leaf) return found.position;
    }
  }

 private:
  struct Slot {
    LeafCoordinates leaf{};
    std::int32_t position = no_leaf;
  };

  static std::size_t hash(const LeafCoordinates& leaf) {
    const std::uint64_t mixed = static_cast<std::uint32_t>(leaf[0]) * 0x9E3779B97F4A7C15u ^
                                static_cast<std::uint32_t>(leaf[1]) * 0xC2B2AE3D27D4EB4Fu ^
                                static_cast<std::uint32_t>(leaf[2]) * 0x165667B19E3779F9u;
    return static_cast<std::size_t>(mixed ^ (mixed >> 29));
  }

  std::vector<Slot> slots_;  // a power of two, at most half full
  std::size_t mask_ = 0;
  std::size_t size_ = 0;
};

}  // namespace bespoke
