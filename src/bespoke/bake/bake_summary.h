#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/statistics.h"
#include "bespoke/types.h"

namespace bespoke {

struct BakeLevelSummary {
  double voxel_size = 0;  ///< mesh units
  std::size_t leaves = 0;
  std::size_t voxels = 0;
};

/// A part of space in which the tolerance was given up.
struct RelaxedRegion {
  Box box;           ///< in the frame of the map's points, mesh units
  double error = 0;  ///< largest that was found there, mesh units
};

struct BakeSummary {
  std::vector<BakeLevelSummary> levels;
  /// |baked − exact| (after BakeOptions::downstream_map), mesh units, over a random sample: no decision of
  /// the bake used its points.
  Statistics error;
  std::size_t error_random_points = 0;   ///< of the sample, anywhere in the band
  std::size_t error_surface_points = 0;  ///< of the sample, in finest cells on the surface
  std::size_t surface_cells = 0;         ///< finest cells on the surface
  bool tolerance_met = false;            ///< error.max ≤ tolerance
  std::vector<RelaxedRegion> relaxed;    ///< to stay within max_leaves; the worst first
  /// Of the surface, by more than max_face_turn, except for those thinner than the smallest voxel that a
  /// nested pyramid may have; of a chain, over its steps.
  std::size_t misoriented_faces = 0;
  std::size_t refined_folds = 0;   ///< cells that folded though the map does not, repaired by finer leaves
  std::size_t repaired_cells = 0;  ///< cells that folded as the map does, repaired by moving nodes
  double repair_cost = 0;          ///< largest distance that a node was moved, mesh units
  std::size_t folded_cells = 0;    ///< cells that still fold or are undecided
  std::size_t evaluated_points = 0;
  std::size_t peak_bytes = 0;  ///< estimate that was held against max_memory
  double refine_seconds = 0;   ///< evaluating the map and growing the pyramid
  double measure_seconds = 0;  ///< evaluating the map at other points
  double repair_seconds = 0;   ///< certifying, refining and repairing folds
  double seconds = 0;
};

/// One line.
std::string to_string(const BakeSummary& summary);

}  // namespace bespoke
