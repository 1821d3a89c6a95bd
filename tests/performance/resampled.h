#pragma once

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// The same surface with about `vertices` vertices: edges are halved until there are enough, then collapsed
/// in the order of their quadric error (mesh/decimation.h).
TriangleMesh resampled(const TriangleMesh& mesh, Eigen::Index vertices);

}  // namespace bespoke
