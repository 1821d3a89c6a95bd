#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// Points sorted into cubic cells, for visits of all points within a radius. The order of a visit depends on
/// the points and the cell size alone.
class PointGrid {
 public:
  /// points: 3×n, finite; cell: edge of a cell, > 0, mesh units (the radius of the usual visit is a good
  /// choice).
  PointGrid(const Points& points, double cell);

  /// Calls visit(index, squared distance) for every point with |p − x| ≤ radius (mesh units).
  template <class Visit>
  void for_each_within(const Vector3& x, double radius, const Visit& visit) const;

  /// Calls visit(begin, end) for ranges of sorted positions that together hold every point of the box
  /// low … high, and few others.
  template <class Visit>
  void for_each_range(const Vector3& low, const Vector3& high, const Visit& visit) const;

  int size() const { return static_cast<int>(order_.size()); }

  /// Sorted position → index of the point.
  const std::vector<int>& order() const { return order_; }

 private:
  using Cell = Eigen::Array3i;
  Cell cell_of(const Vector3& x) const;
  /// Slot of a hash table: a row of cells along x, of which begin … end − 1 hold points; unused where
  /// begin == end.
  struct Row {
    std::uint64_t key = 0;
    int begin = 0;
    int end = 0;
  };
  static std::uint64_t key_of(int j, int k) {
    return (static_cast<std::uint64_t>(k) << 21) | static_cast<std::uint64_t>(j);
  }
  std::size_t first_slot(std::uint64_t key) const {
    // Fibonacci hashing: the high bits of the product mix all bits of the key.
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15u) >> 20) & (rows_.size() - 1);
  }
  std::size_t next_slot(std::size_t slot) const { return (slot + 1) & (rows_.size() - 1); }

  Points sorted_;           // 3×n in cell order
  std::vector<int> order_;  // sorted position → index
  Vector3 origin_ = Vector3::Zero();
  double inverse_cell_ = 1;
  Cell cells_ = Cell::Zero();  // number of cells along each axis
  // Of the cells that hold points, row after row: the place in the row, and the first sorted position, with
  // one more at the end.
  std::vector<int> cell_place_;
  std::vector<int> cell_begin_;
  std::vector<Row> rows_;  // a power of two of them, at most half used
};

/// Indices, increasing, of a subset no two of which are closer than `spacing`, and from which no point is
/// farther than `spacing` (greedy Poisson-disk in the order of the indices). spacing > 0, mesh units.
std::vector<int> thin_points(const Points& points, double spacing);

template <class Visit>
void PointGrid::for_each_within(const Vector3& x, double radius, const Visit& visit) const {
  const double squared_radius = radius * radius;
  for_each_range(x - Vector3::Constant(radius), x + Vector3::Constant(radius), [&](int begin, int end) {
    for (int position = begin; position < end; ++position) {
      const double squared_distance = (sorted_.col(position) - x).squaredNorm();
      if (squared_distance <= squared_radius) visit(order_[position], squared_distance);
    }
  });
}

template <class Visit>
void PointGrid::for_each_range(const Vector3& low, const Vector3& high, const Visit& visit) const {
  const Cell first = cell_of(low).max(0);
  const Cell last = cell_of(high).min(cells_ - 1);
  for (int k = first.z(); k <= last.z(); ++k)
    for (int j = first.y(); j <= last.y(); ++j) {
      const std::uint64_t key = key_of(j, k);
      std::size_t slot = first_slot(key);
      while (rows_[slot].begin < rows_[slot].end && rows_[slot].key != key) slot = next_slot(slot);
      const auto row_end = cell_place_.begin() + rows_[slot].end;
      const auto from = std::lower_bound(cell_place_.begin() + rows_[slot].begin, row_end, first.x());
      auto to = from;
      while (to != row_end && *to <= last.x()) ++to;
      if (from != to)
        visit(cell_begin_[static_cast<std::size_t>(from - cell_place_.begin())],
              cell_begin_[static_cast<std::size_t>(to - cell_place_.begin())]);
    }
}

}  // namespace bespoke
