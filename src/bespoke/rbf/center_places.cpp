#include "bespoke/rbf/center_places.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "bespoke/instruction_set.h"

namespace bespoke {

/// A box, from the origin of the places.
struct CenterPlaces::Box {
  float low[3];
  float high[3];
};

/// Writes the positions that are near to `near`, which has space for all, and their number to `count`.
struct CenterPlaces::Select {
  [[gnu::always_inline]] static void run(const CenterPlaces& places, const std::vector<Range>& ranges,
                                         const Box& box, int* near, std::size_t& count) {
    std::size_t kept = 0;
    for (const Range& range : ranges)
      for (int begin = range.begin; begin < range.end; begin += width) {
        Lanes squared = {};
        for (int axis = 0; axis < 3; ++axis) {
          Lanes at;
          std::memcpy(&at, places.coordinates_[axis].data() + begin, sizeof at);
          const Lanes below = box.low[axis] - at;
          const Lanes above = at - box.high[axis];
          const Lanes farther = below > above ? below : above;
          const Lanes outside = farther > 0 ? farther : Lanes{};
          squared += outside * outside;
        }
        const int lanes = std::min(width, range.end - begin);
        // Unconditional writes: a branch on the distance would be mispredicted about half of the time.
        for (int lane = 0; lane < lanes; ++lane) {
          near[kept] = begin + lane;
          kept += squared[lane] < places.squared_reach_;
        }
      }
    count = kept;
  }
};

CenterPlaces::CenterPlaces(const Points& centers, double reach) {
  if (centers.cols() > 0) origin_ = 0.5 * (centers.rowwise().minCoeff() + centers.rowwise().maxCoeff());
  const Points from_origin = centers.colwise() - origin_;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<float>& row = coordinates_[axis];
    row.assign(static_cast<std::size_t>(centers.cols()) + width, 0);
    for (Eigen::Index i = 0; i < centers.cols(); ++i)
      row[static_cast<std::size_t>(i)] = static_cast<float>(from_origin(axis, i));
  }
  // A coordinate, a side of a box within reach and their difference are each rounded by 2^-24 of their size
  // at most, and so is each term of a squared distance.
  constexpr double rounding = 0x1p-23;
  const double farthest = centers.cols() > 0 ? from_origin.cwiseAbs().maxCoeff() : 0;
  const double generous = (reach + 4 * rounding * (farthest + reach)) * (1 + 4 * rounding);
  squared_reach_ = static_cast<float>(generous * generous * (1 + rounding));
}

void CenterPlaces::append_near(const std::vector<Range>& ranges, const double* low, const double* high,
                               std::vector<int>& near) const {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = static_cast<float>(low[axis] - origin_[axis]);
    box.high[axis] = static_cast<float>(high[axis] - origin_[axis]);
  }
  std::size_t capacity = 0;
  for (const Range& range : ranges) capacity += static_cast<std::size_t>(range.end - range.begin);
  const std::size_t before = near.size();
  near.resize(before + capacity + 1);
  std::size_t count = 0;
  run_dispatched<Select>(*this, ranges, box, near.data() + before, count);
  near.resize(before + count);
}

CenterPlaces CenterPlaces::subset(const std::vector<int>& positions) const {
  CenterPlaces result;
  result.origin_ = origin_;
  result.squared_reach_ = squared_reach_;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<float>& from = coordinates_[axis];
    std::vector<float>& row = result.coordinates_[axis];
    row.assign(positions.size() + width, 0);
    for (std::size_t i = 0; i < positions.size(); ++i) row[i] = from[static_cast<std::size_t>(positions[i])];
  }
  return result;
}

}  // namespace bespoke
