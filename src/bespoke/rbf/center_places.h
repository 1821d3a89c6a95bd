#pragma once

#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// Where a layer's centres lie, in single precision and sixteen at a time: finds those near a box. It may
/// keep a centre that is a millionth farther than requested, but never misses one.
class CenterPlaces {
 public:
  /// centers: 3×n, finite; reach: the distance that counts as near, > 0; mesh units.
  CenterPlaces(const Points& centers, double reach);

  /// Positions begin … end − 1 among the centres.
  struct Range {
    int begin;
    int end;
  };

  /// Appends to `near` the positions out of the ranges whose centres lie within the reach of the box
  /// low … high, mesh units, in the order of the ranges.
  void append_near(const std::vector<Range>& ranges, const double* low, const double* high,
                   std::vector<int>& near) const;

  /// The places of some of the centres, by their positions; what it finds are indices into `positions`.
  CenterPlaces subset(const std::vector<int>& positions) const;

 private:
  CenterPlaces() = default;
  static constexpr int width = 16;
  using Lanes = float __attribute__((vector_size(width * sizeof(float))));
  struct Box;
  struct Select;

  Vector3 origin_ = Vector3::Zero();
  float squared_reach_ = 0;
  std::vector<float> coordinates_[3];  // n and `width` more each, from the origin
};

}  // namespace bespoke
