#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/bake/band.h"
#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"

namespace bespoke {

/// What one uniform level would cost and miss; known before any of it is taken.
struct UniformEstimate {
  double voxel_size = 0;  ///< mesh units
  double bytes = 0;       ///< somewhat too many where there are millions of leaves
  double error = 0;       ///< expected largest trilinear error, mesh units
};

/// Probes the trilinear error at a few thousand cells of the band.
UniformEstimate estimate_uniform(const ElasticMap& map, const Lattice& lattice);

/// Throws MemoryLimitError, naming the voxel size and the tolerance that would fit, when `estimate` needs
/// more than `max_memory` bytes.
void require_memory(const ElasticMap& map, const UniformEstimate& estimate, std::size_t max_memory);

}  // namespace bespoke
