#pragma once

#include <vector>

#include "bespoke/alignment/detail/soft_matches.h"
#include "bespoke/rigid/similarity_alignment.h"

namespace bespoke {

/// A similarity that aligns a source's patches with a target's better than its neighbours do.
struct SimilarityCandidate {
  Similarity target_from_source;
  /// Root mean square distance from soft matches over the share that found some, fraction of the target's
  /// radius; lower is better.
  double misfit = 0;
};

/// The 24 rotations that take axes to axes.
std::vector<Matrix3> axis_rotations();

/// 72 rotations, from one of which no rotation is farther than 45 degrees: those of the icosahedron and those
/// that take axes to axes.
std::vector<Matrix3> covering_rotations();

/// Similarities found by soft matches at a falling length from every start: principal axes of the target ×
/// start × principal axes of the source, centres and radii made equal. Best first; of results that take the
/// source to about the same place only the best.
std::vector<SimilarityCandidate> search_similarities(const SurfacePatches& source,
                                                     const SurfacePatches& target,
                                                     const std::vector<Matrix3>& starts);

}  // namespace bespoke
