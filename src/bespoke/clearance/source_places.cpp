#include "bespoke/clearance/source_places.h"

namespace bespoke {

std::vector<double> SourcePlaces::distances(const DistanceGrid& source) const {
  std::shared_ptr<const Known> known;
  {
    const std::lock_guard lock(mutex_);
    known = known_;
  }
  if (known && known->source == source) return known->distances;
  known = std::make_shared<const Known>(Known{source, source(points())});
  const std::lock_guard lock(mutex_);
  known_ = known;
  return known->distances;
}

}  // namespace bespoke
