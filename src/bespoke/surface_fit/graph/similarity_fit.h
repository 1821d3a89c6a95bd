#pragma once

#include "bespoke/rigid/similarity_alignment.h"
#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/matching/target_surface.h"

namespace bespoke {

struct SimilarityFit {
  Similarity target_from_source;
  double residual =
      0;  ///< a high quantile (settings) of the distances to the target's tangent planes, diagonals
  bool suffices = false;
  /// About that of its translation: the residuals' deviation over the root of their number, diagonals.
  double standard_error = 0;
};

/// Iterated closest compatible points, point to plane, robust weights, from `start` on. The similarity
/// suffices when `residual` is within the tolerance of the settings, or the residuals are noise: those of
/// neighbouring vertices differ. Gives up early when no similarity can.
SimilarityFit fit_similarity(const TriangleMesh& source, const TargetSurface& target, const Similarity& start,
                             const SimilaritySettings& settings = {});

}  // namespace bespoke
