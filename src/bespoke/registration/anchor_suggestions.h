#pragma once

#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/progress.h"

namespace bespoke {

struct SuggestionOptions {
  std::size_t count = 5;  ///< pairs at most
  /// > 0, mesh units of the target: where the fits are as sure as this, nothing is suggested.
  double tolerance = 0;
};

/// A pair for a person to check or correct.
struct SuggestedAnchor {
  AnchorPair pair;         ///< a vertex of the source, the point of the target that the fits propose, its σ
  double uncertainty = 0;  ///< how far apart the fits are around it, mesh units of the target
  double confidence = 0;   ///< of the surface fitting there, in [0, 1] (surface_fit.h)
};

/// Where one more pair would say most (the paper's future work). The source is fitted to the target and the
/// target to the source; how far apart they put a vertex, and how far off the target, is what the surfaces
/// and the pairs so far leave open there. The worst place is suggested first; near it the next is worth less.
/// σ of a suggestion is that of two independent guesses which differ by as much in all three directions.
/// Fewer than `count` where the rest is surer than the tolerance. Throws as fit_mapping.
std::vector<SuggestedAnchor> suggest_anchors(const TriangleMesh& source, const TriangleMesh& target,
                                             const Anchors& anchors, const SuggestionOptions& options,
                                             const Progress& progress = {});

}  // namespace bespoke
