#pragma once

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/progress.h"

namespace bespoke {

/// Experiments: tests/accuracy/tuning.md.
struct CounterpartOptions {
  /// Of the source's diagonal: where every place is nearer to a pair than this, along the surface, none is
  /// looked for. Thirty pairs or so cover a body.
  double remote = 0.2;
  /// Of the source's diagonal: the smallest distance of a place from pairs and other places.
  double spacing = 0.1;
  /// Of the source's diagonal: so near to a pair or a place in space none is taken, however far it is along
  /// the surface: a warp of space cannot separate them across a seam or where parts touch.
  double touching = 0.01;
  int max_count = 30;  ///< places
  int sweeps = 2;      ///< in which every counterpart is determined again from all the others
  /// Of the largest distance: added to a distance, so that the nearest pairs do not decide alone.
  double softening = 0.02;
  std::size_t max_pairs = 16;  ///< measured from, those farthest apart: each is two walks over a surface
  /// Counterparts with a larger misfit are left out: there the target ends where the source goes on.
  double max_misfit = 0.25;
};

/// Places of the source far from all pairs, and where distances along the surfaces put them on the target.
struct GeodesicCounterparts {
  Points sources;  ///< 3×k, on the source, source frame, mesh units
  Points targets;  ///< 3×k, on the target, target frame, mesh units
};

/// 3×k each, on or near the surfaces.
struct CounterpartPairs {
  const Points& sources;
  const Points& targets;
};

/// Not in the paper: distances along a surface change little with the pose (Elad, Kimmel 2003), so they
/// locate places taken by farthest point sampling. The counterpart of p is the target vertex q with the least
///   Σ wᵢ (d_b(q, qᵢ) − ρ d_a(p, pᵢ))²,  wᵢ = 1 / (ρ d_a(p, pᵢ) + ε)²
/// over the pairs (pᵢ, qᵢ) so far; ρ: the median ratio of their distances. Empty where no place is remote.
/// Throws InvalidInput for unusable meshes and other sizes.
GeodesicCounterparts geodesic_counterparts(const TriangleMesh& source, const TriangleMesh& target,
                                           const CounterpartPairs& pairs,
                                           const CounterpartOptions& options = {},
                                           const Progress& progress = {});

}  // namespace bespoke
