#include "bespoke/lattice/brick_table.h"

#include <cassert>

namespace bespoke {
namespace {

template <class Body>
void for_each_in_cube(const LatticeCoordinates& first, int edge, const Body& body) {
  for (int i = 0; i < edge; ++i)
    for (int j = 0; j < edge; ++j)
      for (int k = 0; k < edge; ++k) body(moved(first, {i, j, k}));
}

constexpr LatticeCoordinates scaled_up(const LatticeCoordinates& at, int bits) {
  return {at[0] << bits, at[1] << bits, at[2] << bits};
}
constexpr LatticeCoordinates scaled_down(const LatticeCoordinates& at, int bits) {
  return {at[0] >> bits, at[1] >> bits, at[2] >> bits};
}

}  // namespace

BrickTable::BrickTable(const LatticeCoordinates& low, const LatticeCoordinates& high,
                       std::size_t largest_grid) {
  assert(largest_grid >= 27);
  for (;; grid_shift_ += bits_per_table) {
    low_ = moved(scaled_down(low, grid_shift_), {-1, -1, -1});
    const LatticeCoordinates last = scaled_down(moved(high, {-1, -1, -1}), grid_shift_);
    double entries = 1;
    for (int axis = 0; axis < 3; ++axis) {
      size_[axis] = last[axis] - low_[axis] + 1;
      entries *= size_[axis];
    }
    if (entries <= static_cast<double>(largest_grid)) break;
  }
  grid_.assign(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                   static_cast<std::size_t>(size_[2]),
               0);
}

LatticeCoordinates BrickTable::low() const { return scaled_up(low_, grid_shift_); }

LatticeCoordinates BrickTable::high() const { return scaled_up(moved(low_, size_), grid_shift_); }

std::size_t BrickTable::entry_in_grid(const LatticeCoordinates& at) const {
  const auto column = static_cast<std::size_t>(at[0] - low_[0]) * static_cast<std::size_t>(size_[1]) +
                      static_cast<std::size_t>(at[1] - low_[1]);
  return column * static_cast<std::size_t>(size_[2]) + static_cast<std::size_t>(at[2] - low_[2]);
}

// The table behind an entry, which gets one that says everywhere what the entry said.
std::size_t BrickTable::table_at(Reference& entry) {
  if (entry & table_flag) return entry & ~table_flag;
  const std::size_t table = tables_.size() / table_entries;
  const Reference before = entry;
  entry = static_cast<Reference>(table) | table_flag;  // before the tables move in memory
  tables_.resize(tables_.size() + table_entries, before);
  return table;
}

void BrickTable::set(const LatticeCoordinates& region, int bits, Reference reference) {
  if (bits >= grid_shift_)
    return for_each_in_cube(scaled_up(region, bits - grid_shift_), 1 << (bits - grid_shift_),
                            [&](const LatticeCoordinates& at) { grid_[entry_in_grid(at)] = reference; });
  int shift = grid_shift_;
  std::size_t table = table_at(grid_[entry_in_grid(scaled_down(region, shift - bits))]);
  for (shift -= bits_per_table; shift > bits; shift -= bits_per_table) {
    const LatticeCoordinates at = scaled_down(region, shift - bits);
    table = table_at(tables_[entry_in(table, at[0], at[1], at[2])]);
  }
  for_each_in_cube(scaled_up(region, bits - shift), 1 << (bits - shift), [&](const LatticeCoordinates& at) {
    tables_[entry_in(table, at[0], at[1], at[2])] = reference;
  });
}

}  // namespace bespoke
