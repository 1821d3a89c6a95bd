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
  std::optional<double> voxel_size;  ///< one uniform level of this size (mesh units) instead of the
                                     ///< adaptive pyramid
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
  std::size_t refined_folds = 0;   ///< cells that folded though the map does not, mended by finer leaves
  std::size_t repaired_cells = 0;  ///< cells that folded as the map does, mended by moving nodes
  double repair_cost = 0;          ///< largest distance that a node was moved, mesh units
  std::size_t folded_cells = 0;    ///< cells that still fold or are undecided
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

/// Samples u of the map over its support as a nested pyramid that is fine only where the map needs it, or on
/// one lattice (DESIGN, step 5). Cells of the pyramid that fold are refined, then repaired; where not all
/// can be, none is, and their number is in the summary. Reproduces affine
/// maps exactly (no leaf at all). Throws MemoryLimitError before taking the memory, naming the voxel size (or
/// tolerance) that would fit; InvalidInput for values out of range.
Bake bake(const ElasticMap& map, const BakeOptions& options, const Progress& progress = {});

}  // namespace bespoke
