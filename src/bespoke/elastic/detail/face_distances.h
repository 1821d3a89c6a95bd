#pragma once

#include <array>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// All triangles within one radius of a point, with their squared distances: what a blend over neighbouring
/// faces requires at every point. Thread-safe; what is found, and in which order, depends on the triangles,
/// the radius and the point alone.
class FaceDistances {
 public:
  struct Near {
    int place;                ///< in order()
    double squared_distance;  ///< < radius²
  };
  /// Memory that queries of one thread share.
  struct Scratch {
    std::vector<double> distances;
    std::vector<Near> near;
  };

  /// corners: the three corners of each triangle as columns, mesh units, with area; at least one triangle.
  /// radius > 0, mesh units.
  FaceDistances(const std::vector<Matrix3>& corners, double radius);

  /// Place → index in `corners`: triangles near each other have places near each other.
  const std::vector<int>& order() const { return order_; }

  /// The triangles closer than the radius. Valid until the scratch is used again.
  const std::vector<Near>& find(const Vector3& x, Scratch& scratch) const;

 private:
  using Column = std::vector<double>;  // one number a triangle, in order_

 public:
  /// What the distance of a point needs to know of each triangle, one number a column.
  struct Columns {
    std::array<Column, 3> corner, first, second;  ///< a, b − a, c − a
    Column bb, bc, cc;                            ///< dot products of the edges
    Column inverse_det, inverse_bb, inverse_cc, inverse_ee;
  };

 private:
  int cell_along(int axis, double coordinate) const;

  std::vector<int> order_;
  Columns columns_;
  double radius_;
  double reach_ = 0;  // radius plus the largest distance of a triangle's centre from its corners
  Vector3 low_;       // of the grid of the triangles' centres
  double cell_ = 0;
  std::array<int, 3> cells_{};
  std::vector<int> cell_start_;  // x runs fastest; cells + 1
};

}  // namespace bespoke
