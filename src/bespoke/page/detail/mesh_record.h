#pragma once

#include <string>
#include <vector>

#include "bespoke/page/detail/display_mesh.h"
#include "bespoke/page/detail/packed_arrays.h"
#include "bespoke/page/detail/vertex_fields.h"

namespace bespoke {

/// A mesh of a scene, before it is packed.
struct MeshToShow {
  const char* role;  ///< "source", "target" or "product"
  const std::string& name;
  const TriangleMesh& whole;
  const DisplayMesh& display;
  const std::vector<Points>& knots;  ///< 3×(vertices shown) each, mesh units
  const std::vector<VertexField>& fields;
  const std::string& unit;
};

/// Its record (MeshRecord in src/pages/scene/scene.ts), its numbers added to the arrays.
Json mesh_record(const MeshToShow& mesh, PackedArrays& arrays);

}  // namespace bespoke
