#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/bake/node_values.h"
#include "bespoke/certificate/certificate.h"
#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/progress.h"
#include "bespoke/statistics.h"

namespace bespoke {

struct BakeOptions {
  double tolerance = 0;              ///< wanted largest |baked − exact|, > 0, mesh units
  std::optional<double> voxel_size;  ///< one uniform level of this size (mesh units) instead of the
                                     ///< adaptive pyramid
  std::size_t max_memory = std::size_t{8} << 30;  ///< bytes that the bake may take
  /// Leaves that the pyramid may have, where given: the places of the largest errors get them, and of these
  /// the ones near the surface before others; the rest miss the tolerance and are named
  /// (BakeSummary::relaxed). A tenth is kept for folds and faces that turn first. Few more for level
  /// boundaries.
  std::optional<std::size_t> max_leaves;
  /// Random points of the band at which the error is measured; of twice as many the finest cells on the
  /// surface have an equal share, one to 27 each.
  std::size_t error_points = 100'000;
  /// The source, in its frame: the error is measured in the finest cells that it passes through. Without it,
  /// in some cells of every leaf. Must outlive the call.
  const TriangleMesh* surface = nullptr;
  /// Degrees: leaves are added where the baked map turns a face of `surface` farther against the map.
  double max_face_turn = 15;
  /// What follows the map, where it is a step of a chain: errors are measured where it takes them. Must
  /// outlive the call.
  const ElasticMap* downstream_map = nullptr;
  /// Half precision stores 16 bits a number. Error, certificate and all decisions are about the rounded
  /// values.
  ValuePrecision precision = ValuePrecision::single;
  NodeValues nodes = NodeValues::balanced;  ///< of a nested pyramid; one uniform level is sampled
};

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

struct Bake {
  Pyramid pyramid;
  Certificate certificate;  ///< of the pyramid, at t = 1; its seconds are among repair_seconds
  BakeSummary summary;
};

/// Samples u of the map over its support as a nested pyramid, or on one lattice (src/bespoke/README.md,
/// "Bake"); affine maps exactly. Folded cells of a pyramid are refined, then repaired, all or none; the
/// summary counts the rest. Where ‖∇u‖ > 2 or u jumps, voxels stop at half the tolerance, which may then be
/// missed. A BakedMap is stored as it is, unless a voxel size is given. Throws MemoryLimitError, naming what
/// would fit; InvalidInput for values out of range, also of half precision.
Bake bake(const ElasticMap& map, const BakeOptions& options, const Progress& progress = {});

}  // namespace bespoke
