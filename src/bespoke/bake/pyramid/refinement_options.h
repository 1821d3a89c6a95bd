#pragma once

#include <cstddef>
#include <optional>

#include "bespoke/bake/node_values.h"
#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

struct RefinementOptions {
  double tolerance = 0;        ///< wanted largest |baked − exact|, > 0, mesh units
  std::size_t max_memory = 0;  ///< bytes, of all that a bake holds for the leaves at a time
  ValuePrecision precision = ValuePrecision::single;
  NodeValues nodes = NodeValues::balanced;
  std::optional<std::size_t> max_leaves;       ///< BakeOptions::max_leaves
  const TriangleMesh* surface = nullptr;       ///< BakeOptions::surface
  const ElasticMap* downstream_map = nullptr;  ///< BakeOptions::downstream_map
  double growth = 1;                           ///< power_of_two_scale the map's affine part: sizes grow by it
  double growth_after = 1;                     ///< power_of_two_scale that of `then`

  /// The tolerance where the map ends, to hold values of u against.
  double tolerance_of_values() const { return tolerance / growth_after; }
  /// Where it begins, to hold voxels against.
  double tolerance_of_places() const { return tolerance_of_values() / growth; }
};

}  // namespace bespoke
