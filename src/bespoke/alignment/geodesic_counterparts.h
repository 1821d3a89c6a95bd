#pragma once

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/progress.h"

namespace bespoke {

/// Chosen by the errors of fits on 26 pairs (poses, hands, other persons, scans; the nine shared cases that
/// are not copies) of which five anchors were kept: 0.55 % in the geometric mean without counterparts, 0.37 %
/// with them.
struct CounterpartOptions {
  /// Of the source's diagonal: where every place is nearer to a pair than this, along the surface, none is
  /// looked for. Thirty pairs or so on a body leave 0.14.
  double remote = 0.2;
  /// Of the source's diagonal: the smallest distance of a place from pairs and other places.
  double spacing = 0.1;
  /// Of the source's diagonal: so near to a pair or a place in space none is taken, however far it is along
  /// the surface. Across a seam or where parts touch, a warp of space cannot tell them apart. Not varied.
  double touching = 0.01;
  int max_count = 30;  ///< places
  int sweeps = 2;  ///< in which every counterpart is looked for again by all the others. 3 and 4: the same.
  /// Of the largest distance: added to a distance, so that pairs at hand do not decide alone. 0.05: 0.37 %.
  double softening = 0.02;
  std::size_t max_pairs = 16;  ///< measured from, those farthest apart: each is two walks over a surface
  /// Counterparts with a larger misfit are left out: 0.03 to 0.25 on poses and on other persons, 0.25 to 0.9
  /// on scans that end where the source goes on.
  double max_misfit = 0.25;
};

/// Places of the source far from all pairs, and where distances along the surfaces put them on the target.
struct GeodesicCounterparts {
  Points sources;  ///< 3×k, on the source, source frame, mesh units
  Points targets;  ///< 3×k, on the target, target frame, mesh units
};

/// Not in the paper. A pose bends a surface and hardly stretches it, so distances along it tell a place in
/// any pose, as three distances tell a place on a plane (Elad, Kimmel 2003 embed surfaces by them). Places of
/// the source are taken one by one, each the farthest from the pairs and places before it: ends of limbs come
/// first. The counterpart of a place p is the vertex q of the target with the least
///   Σ wᵢ (d_b(q, qᵢ) − ρ d_a(p, pᵢ))²,  wᵢ = 1 / (ρ d_a(p, pᵢ) + ε)²
/// over the pairs and places (pᵢ, qᵢ) so far; ρ is the median ratio of the distances among the pairs. Misfit:
/// the root of the weighted mean of these squares over the least ρ d_a(p, pᵢ).
///
/// sources, targets: 3×k, pairs of points on or near the surfaces. What is on another component than all of
/// them finds nothing. Empty where no place is remote. A mean of 1 to 3 % of the diagonal off, 10 % at most
/// where bodies bend their knees. Throws InvalidInput for unusable meshes or other numbers of points.
GeodesicCounterparts geodesic_counterparts(const TriangleMesh& source, const TriangleMesh& target,
                                           const Points& sources, const Points& targets,
                                           const CounterpartOptions& options = {},
                                           const Progress& progress = {});

}  // namespace bespoke
