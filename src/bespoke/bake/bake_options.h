#pragma once

#include <cstddef>
#include <optional>

#include "bespoke/bake/node_values.h"
#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/mesh/triangle_mesh.h"

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

}  // namespace bespoke
