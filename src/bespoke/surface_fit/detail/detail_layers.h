#pragma once

#include <vector>

#include "bespoke/progress.h"
#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/matching/target_surface.h"

namespace bespoke {

/// What the layers move. Lengths in diagonals.
struct DetailInput {
  const TriangleMesh& surface;  ///< the source as fitted so far
  const TargetSurface& target;
  const Points& anchor_sources;   ///< 3×k: exact anchors, where they are now
  const Points& anchor_targets;   ///< 3×k
  std::vector<char> hidden = {};  ///< n: vertices without counterpart; empty where all may have one
  FacePatches patches = {};       ///< of the faces of `surface`; excluded ones have no counterparts
};

struct DetailFit {
  Points vertices;        ///< 3×n
  Points anchor_sources;  ///< 3×k
  int layers = 0;
  double last_step = 0;  ///< root mean square of the last layer's displacements, diagonals
};

/// Small deformations of space, coarse to fine, from a few per cent of the diagonal down to the spacing of
/// the vertices: the residuals to the closest compatible points (point to plane mostly) are averaged around
/// thinned centres a fraction of λ apart, interpolated by Wendland's C4 function of radius λ, scaled so that
/// ‖∇u‖ stays well below one at the vertices, and move all vertices. Exact anchors are a layer's first
/// centres, but those nearer to another than the centres are apart.
DetailFit fit_details(const DetailInput& input, const DetailSettings& settings, const Progress& progress);

/// A layer that carries the exact anchors onto their targets and vanishes a short way off, and others after
/// it while these are missed by more than DetailSettings::tolerance.
DetailFit meet_anchors(const DetailInput& input, const DetailSettings& settings = {});

}  // namespace bespoke
