#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bespoke/lattice/leaf.h"

namespace bespoke {

/// Finds what lies at a *place*: a cube of space in units of the smallest ones there are. A dense grid over
/// the box of all places, coarse enough to stay small, and below it tables of 4³ only where regions are
/// smaller: one load for the grid and one for each factor of four. Thread-safe to read.
class BrickTable {
 public:
  using Reference = std::uint32_t;  ///< below 2³¹; 0 where nothing was set

  BrickTable() = default;
  /// For places from `low` up to but without `high`, each below 2³⁰ in size. The grid has `largest_grid`
  /// entries at most (27 at least) and an empty layer below the box.
  BrickTable(const LatticeCoordinates& low, const LatticeCoordinates& high, std::size_t largest_grid);

  /// For the 2^bits cubed places of the region whose number is `region` in units of its own size. Larger
  /// regions before the smaller ones in them.
  void set(const LatticeCoordinates& region, int bits, Reference reference);

  /// The places that find covers, `high` not included.
  LatticeCoordinates low() const;
  LatticeCoordinates high() const;

  std::size_t byte_count() const { return sizeof(Reference) * (grid_.size() + tables_.size()); }

  /// What was set for places, all within low() and high(). Steps of all of them go together, because one
  /// place after the other would wait for its loads and guess wrongly how many there are.
  [[gnu::always_inline]] void find(const std::int32_t* x, const std::int32_t* y, const std::int32_t* z,
                                   std::size_t count, Reference* found) const {
    Reference tables = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto column = static_cast<std::ptrdiff_t>((x[i] >> grid_shift_) - low_[0]) * size_[1] +
                          ((y[i] >> grid_shift_) - low_[1]);
      found[i] = grid_[static_cast<std::size_t>(column * size_[2] + ((z[i] >> grid_shift_) - low_[2]))];
      tables |= found[i];
    }
    for (int shift = grid_shift_ - bits_per_table; tables & table_flag; shift -= bits_per_table) {
      tables = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t entry =
            entry_in(found[i] & ~table_flag, x[i] >> shift, y[i] >> shift, z[i] >> shift);
        const bool is_table = found[i] & table_flag;
        const Reference next = tables_[is_table ? entry : 0];
        found[i] = is_table ? next : found[i];
        tables |= found[i];
      }
    }
  }

 private:
  static constexpr Reference table_flag = 1u << 31;
  static constexpr int bits_per_table = 2;
  static constexpr std::size_t table_entries = 64;

  static constexpr std::size_t entry_in(std::size_t table, int x, int y, int z) {
    return table_entries * table + static_cast<std::size_t>((x & 3) << 4 | (y & 3) << 2 | (z & 3));
  }
  std::size_t entry_in_grid(const LatticeCoordinates& at) const;
  std::size_t table_at(Reference& entry);

  std::vector<Reference> grid_{0};
  std::vector<Reference> tables_;     // 4³ entries each
  LatticeCoordinates low_{0, 0, 0};   // of the grid, in units of its entries
  LatticeCoordinates size_{1, 1, 1};  // of the grid
  int grid_shift_ = 0;                // an entry of the grid covers 2^grid_shift_ cubed places
};

}  // namespace bespoke
