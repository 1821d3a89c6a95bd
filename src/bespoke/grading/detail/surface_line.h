#pragma once

#include "bespoke/mesh/closest_point.h"

namespace bespoke {

struct SurfaceLineOptions {
  bool closed = false;  ///< from the last point back to the first
  double spacing = 0;   ///< most between two points of the line, mesh units, > 0
};

/// A line over a surface through the closest points of 3×n points near it, 3×m: pieces longer than the
/// spacing are split at the closest point of their middle, which on a smooth surface comes near to the
/// shortest way. Throws InvalidInput, naming the points by their numbers from 1, where there is no such way
/// (from one leg to the other), for fewer than two points, or three of a closed line.
Points surface_line(const ClosestPointTree& surface, const Points& points, const SurfaceLineOptions& options);

}  // namespace bespoke
