#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "bespoke/lattice/leaf.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Values at the nodes of some leaves of a lattice: node i lies at origin + cell · i.
struct SparseField {
  static constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

  Vector3 origin;                       ///< mesh units
  double cell = 0;                      ///< edge, mesh units
  std::vector<LeafCoordinates> leaves;  ///< in lexicographic order, each once
  std::vector<float> values;            ///< 512 a leaf, by number_of_place; unknown where there is none

  Vector3 place(const LatticeCoordinates& node) const {
    return origin + cell * Vector3(node[0], node[1], node[2]);
  }
};

/// Where a vertex goes that starts at the mean of where its cell's edges change sign; empty when the surface
/// is not to have it.
using PlaceVertex = std::function<std::optional<Vector3>(const Vector3& start)>;

/// The surface between negative and other values, seen from the latter: a vertex for every cell whose eight
/// values are known and differ in sign, and around every edge that changes sign a quadrilateral of the four
/// cells' vertices, cut along its shorter diagonal (surface nets: Gibson 1998). It ends, with a boundary,
/// where one of the four lacks. Vertices and faces are in the order of the leaves. `place` is called from
/// several threads.
TriangleMesh surface_net(const SparseField& field, const PlaceVertex& place);

}  // namespace bespoke
