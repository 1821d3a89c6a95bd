#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"
#include "bespoke/statistics.h"
#include "bespoke/volume/pyramid.h"

namespace bespoke {

struct BakeOptions {
  double tolerance = 0;              ///< wanted largest |baked − exact|, > 0, mesh units
  std::optional<double> voxel_size;  ///< one uniform level of this size (mesh units) instead of one chosen to
                                     ///< meet the tolerance
  std::size_t max_memory = std::size_t{8} << 30;  ///< bytes that the bake may take
  std::size_t error_points = 1'000'000;  ///< random points of the band at which the error is measured
};

struct BakeLevelSummary {
  double voxel_size = 0;  ///< mesh units
  std::size_t leaves = 0;
  std::size_t voxels = 0;
};

struct BakeSummary {
  std::vector<BakeLevelSummary> levels;
  Statistics error;            ///< |baked − exact| at places that no decision of the bake used, mesh units
  bool tolerance_met = false;  ///< error.max ≤ tolerance
  std::size_t evaluated_points = 0;
  std::size_t peak_bytes = 0;  ///< estimate that was held against max_memory
  double seconds = 0;
};

/// One line.
std::string to_string(const BakeSummary& summary);

struct Bake {
  Pyramid pyramid;
  BakeSummary summary;
};

/// Samples u of the map on a lattice over its support (DESIGN, step 5). Reproduces affine maps exactly (no
/// leaf at all). Throws MemoryLimitError before taking the memory, naming the voxel size (or tolerance) that
/// would fit; InvalidInput for values out of range.
Bake bake(const ElasticMap& map, const BakeOptions& options, const Progress& progress = {});

}  // namespace bespoke
