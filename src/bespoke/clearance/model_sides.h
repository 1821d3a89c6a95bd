#pragma once

#include "bespoke/asset/asset.h"

namespace bespoke {

/// The asset with the signed distances of its two models (with_model_distances), the side as SignedDistance
/// says: by the generalised winding number, of open models by the angle-weighted normal too. `source` in its
/// own frame, `target` in its own. Throws InvalidInput without previews.
Asset with_model_sides(Asset asset, const TriangleMesh& source, const TriangleMesh& target);

}  // namespace bespoke
