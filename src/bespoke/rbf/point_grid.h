#pragma once

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
  /// Range of sorted positions of the points in a cell; empty when the cell holds none.
  struct Range {
    int begin = 0;
    int end = 0;
  };
  Range range(const Cell& cell) const;

  Points sorted_;           // 3×n in cell order
  std::vector<int> order_;  // sorted position → index
  Vector3 origin_ = Vector3::Zero();
  double inverse_cell_ = 1;
  Cell cells_ = Cell::Zero();             // number of cells along each axis
  std::vector<std::uint64_t> cell_keys_;  // of the occupied cells, increasing
  std::vector<int> cell_start_;           // occupied cells + 1
  std::vector<std::uint32_t> bucket_;     // hash table: slot → occupied cell + 1
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
    for (int j = first.y(); j <= last.y(); ++j)
      for (int i = first.x(); i <= last.x(); ++i) {
        const Range found = range(Cell(i, j, k));
        if (found.begin < found.end) visit(found.begin, found.end);
      }
}

}  // namespace bespoke
