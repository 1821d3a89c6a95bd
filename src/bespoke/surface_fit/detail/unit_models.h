#pragma once

#include "bespoke/rigid/similarity_alignment.h"
#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {

/// The similarity nearest to the warp.
Similarity similarity_of_warp(const SurfaceFitInput& input);

/// The models, scaled so that the source's diagonal is 1, and that of the source aligned with the target as
/// well: lengths are then fractions of it.
class UnitModels {
 public:
  /// Refers to `input`, which must outlive it.
  explicit UnitModels(const SurfaceFitInput& input);

  /// Refers to this and to what this was made of.
  SurfaceFitInput input() const;

  /// Back in mesh units.
  SurfaceFit restored(SurfaceFit fit) const;

 private:
  const SurfaceFitInput& given_;
  double source_size_, target_size_;  // mesh units: what becomes 1
  TriangleMesh source_, target_;
  Points warped_, anchor_sources_, anchor_targets_;
};

}  // namespace bespoke
