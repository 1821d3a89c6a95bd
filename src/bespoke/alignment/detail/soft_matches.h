#pragma once

#include "bespoke/alignment/detail/surface_patches.h"

namespace bespoke {

/// What each patch of the source finds on the target: the mean of its counterparts, by likelihood.
struct SoftMatches {
  Points targets;           ///< 3×n, mesh units
  Eigen::VectorXd weights;  ///< n, shares of the open areas of both surfaces, sum at most 2
  double spread = 0;  ///< Σ over pairs of weight × |target − mean of all targets|², mesh units squared

  /// Share of what lies in the open of the two surfaces that found counterparts, in [0, 1].
  double matched() const { return weights.sum() / 2; }
  /// Root mean square distance of `points` (3×n, the source's patches) from their targets, mesh units.
  double residual(const Points& points) const;
};

/// Likelihood of a pair: exp(−½ (|p − q|²/σ² + |m − n|²/σ_n² + (κ − κ')² + (β − β')²/σ_β²)) with normals m,
/// n, bounded curvatures κ and boundary flags β. Every patch of either surface shares its open area out among
/// its counterparts and a constant that stands for "none" (about 3 σ away), so that what only one model has
/// pulls nothing. `points`, `normals`: 3×n, the source's patches as they lie now; `length`: σ > 0, mesh
/// units.
SoftMatches soft_matches(const SurfacePatches& source, const Points& points, const Points& normals,
                         const SurfacePatches& target, double length);

}  // namespace bespoke
