#pragma once

#include "bespoke/alignment/detail/surface_patches.h"

namespace bespoke {

/// Root mean square distance of a model from its own mirror image, registered to it as well as a rigid motion
/// can; fraction of the model's radius. 0 for what is mirror-symmetric. `patches`: of `mesh`.
double mirror_asymmetry(const TriangleMesh& mesh, const SurfacePatches& patches);

}  // namespace bespoke
