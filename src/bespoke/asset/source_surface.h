#pragma once

#include "bespoke/asset/asset.h"

namespace bespoke {

/// The surface of an asset's source as its distance field shows it: a closed surface, about 128 voxels along
/// the diagonal, a vertex in every cell that it passes through (Gibson's surface nets); of an open source the
/// shell around it. Source frame, mesh units. Throws InvalidInput for an asset without previews.
TriangleMesh source_surface(const Asset& asset);

}  // namespace bespoke
