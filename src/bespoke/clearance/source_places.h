#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "bespoke/asset/model_distances.h"

namespace bespoke {

/// Places of a product on the source, with their distances from it, which maps of one source share. Any
/// number of threads may use one.
class SourcePlaces {
 public:
  /// 3×n, source frame.
  SourcePlaces(Points points) : points_([points = std::move(points)] { return points; }) {}
  /// The same where they are made when they are needed.
  explicit SourcePlaces(std::function<Points()> points) : points_(std::move(points)) {}

  Points points() const { return points_(); }

  /// n, mesh units: looked up once for grids in turn that are the same.
  std::vector<double> distances(const DistanceGrid& source) const;

 private:
  struct Known {
    DistanceGrid source;
    std::vector<double> distances;
  };

  std::function<Points()> points_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const Known> known_;
};

}  // namespace bespoke
