#pragma once

#include <cstddef>

#include "bespoke/types.h"

namespace bespoke {

/// A map that moves points by something else than the source, too, so that u ≠ 0 does not tell what is within
/// reach of it.
class HasOwnReach {
 public:
  virtual ~HasOwnReach() = default;

  /// How many columns of x (3×n, mesh units) are within reach of the source.
  virtual std::size_t count_in_reach(const Points& x) const = 0;
};

/// Of a map with u at the columns of x: what it says itself, else those where u ≠ 0.
template <class Map>
std::size_t count_in_reach(const Map& map, const Points& x, const Points& u) {
  if (const auto* own = dynamic_cast<const HasOwnReach*>(&map)) return own->count_in_reach(x);
  return x.cols() == 0 ? 0 : static_cast<std::size_t>((u.array() != 0).colwise().any().count());
}

}  // namespace bespoke
