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

/// Where a vertex goes that the lattice puts here; empty when the surface is not to have it.
using PlaceVertex = std::function<std::optional<Vector3>(const Vector3& start)>;

/// The surface between negative and other values, seen from the latter, of the cells whose eight values are
/// known (OpenVDB's VolumeToMesh, which gives a cell as many vertices as sheets go through it: the surface is
/// manifold). Of its quadrilaterals the shorter diagonal divides each. It ends, with a boundary, at the other
/// cells and where vertices have no place. `place` is called from several threads.
TriangleMesh surface_net(const SparseField& field, const PlaceVertex& place);

}  // namespace bespoke
