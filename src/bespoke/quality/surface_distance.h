#pragma once

#include <cstddef>
#include <string>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/statistics.h"

namespace bespoke {

/// How far two surfaces lie from each other, both ways, mesh units.
struct SurfaceDistance {
  Statistics a_to_b;     ///< of points of a from the surface b, each standing for the same area of a
  Statistics b_to_a;     ///< the same the other way
  double hausdorff = 0;  ///< the largest of all, vertices of both included
};

struct SurfaceDistanceOptions {
  std::size_t samples = 100000;  ///< on each surface, > 0
};

/// Distances of the columns of `points` (3×n) from a surface, mesh units. Parallel inside.
std::vector<double> distances(const Points& points, const ClosestPointTree& surface);

/// Throws InvalidInput for meshes that are not valid, that have no area, or without samples.
SurfaceDistance surface_distance(const TriangleMesh& a, const TriangleMesh& b,
                                 const SurfaceDistanceOptions& options = {});

/// One line.
std::string to_string(const SurfaceDistance& distance);

}  // namespace bespoke
