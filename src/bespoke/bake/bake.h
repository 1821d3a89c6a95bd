#pragma once

#include "bespoke/bake/bake_options.h"
#include "bespoke/bake/bake_summary.h"
#include "bespoke/certificate/certificate.h"
#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"

namespace bespoke {

struct Bake {
  Pyramid pyramid;
  Certificate certificate;  ///< of the pyramid, at t = 1; its seconds are among repair_seconds
  BakeSummary summary;
};

/// Samples u of the map over its support as a nested pyramid, or on one lattice (src/bespoke/README.md,
/// "Bake"); affine maps exactly. Folded cells of a pyramid are refined, then repaired, all or none; the
/// summary counts the rest. Where ‖∇u‖ > 2 or u jumps, voxels stop at half the tolerance, which may then be
/// missed. A BakedMap is stored as it is, unless a voxel size is given. Throws MemoryLimitError, naming what
/// would fit; InvalidInput for values out of range, also of half precision.
Bake bake(const ElasticMap& map, const BakeOptions& options, const Progress& progress = {});

}  // namespace bespoke
