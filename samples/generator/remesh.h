#pragma once

#include "bespoke/mesh/triangle_mesh.h"
#include "solid.h"

#include <optional>

namespace bespoke {

struct RemeshOptions {
  double finest = 0.3;      ///< shortest wanted edge, cm
  double coarsest = 2.0;    ///< longest wanted edge, cm
  double deviation = 0.02;  ///< wanted distance of an edge's middle from the surface, cm
  int passes = 8;
};

/// Nearly equilateral triangles with vertices on the zero surface of `field`, shorter where the surface
/// bends. `mesh`: manifold, near that surface. Its boundary, if any, is kept on the zero surface of `cut`.
TriangleMesh remesh(const TriangleMesh& mesh, const Field& field, const std::optional<Field>& cut,
                    const RemeshOptions& options);

}  // namespace bespoke
