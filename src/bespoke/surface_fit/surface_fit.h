#pragma once

#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/anchors/patch_faces.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/progress.h"
#include "bespoke/statistics.h"
#include "bespoke/surface_fit/surface_fit_methods.h"
#include "bespoke/surface_fit/surface_fit_options.h"

namespace bespoke {

enum class StopReason {
  converged,
  stagnated,
  iteration_cap,
  unprinted_cap,  ///< the cap on iterations, in the paper's method, which has none
};

const char* to_string(StopReason reason);

/// An exact anchor that is not met, since meeting it would stretch the surface too much.
struct AnchorGivenWay {
  std::size_t index = 0;  ///< of the fit's anchors
  double sigma = 0;       ///< accuracy that it was given instead, mesh units
};

struct SurfaceFitSummary {
  /// Distance of the warped source's vertices from the target surface, without what is excluded or lies in
  /// cavities that the target lacks, mesh units.
  Statistics before;
  Statistics after;  ///< the same for the fitted source
  int iterations = 0;
  StopReason stop_reason = StopReason::iteration_cap;
  std::size_t unmatched_vertices =
      0;  ///< no compatible point in the last iteration: moved by the smoothness term alone
  bool target_flipped = false;  ///< its faces, since one of the models is inside out
  double stiffness = 0;         ///< laplacian: s of Eq. 11
  // deformation-graph:
  bool similarity_suffices = false;  ///< one similarity explains the target, nothing else was fitted
  /// Largest angle between the rotation of a part, as the anchors alone determine it, and the mean rotation;
  /// where it was determined.
  double anchor_turn_degrees = 0;
  bool posed_by_anchors = false;  ///< the anchors alone bent the source before anything else
  /// How much more than other pairs the models keep their shape, 1 to 10; similarities of parts count by it.
  double rigidity = 1;
  int matched_boundaries = 0;  ///< open boundaries of the source taken for the target's cut
  /// By index: in cavities that the target lacks, so they follow their neighbours (detail/cavities.h), or the
  /// space around (detail/unmatched_cavities.h).
  std::vector<int> cavity_vertices;
  /// By index: without counterpart since a patch excludes it, or what lies nearest to it on the target.
  std::vector<int> excluded_vertices;
  std::size_t repaired_vertices = 0;  ///< drawn over a fold or stretched, so they follow their neighbours
  std::vector<int>
      stretched_vertices;  ///< of those, by index: stretched beyond SurfaceFitOptions::max_stretch
  std::vector<AnchorGivenWay> anchors_given_way;
  bool tested_anchors = false;               ///< whether outliers among them would have been found
  std::vector<std::size_t> outlier_anchors;  ///< of the fit's anchors, left out of it
  std::size_t off_surface_anchors = 0;       ///< too far from the source's surface to say where it goes
  double seconds = 0;
};

/// One line.
std::string to_string(const SurfaceFitSummary& summary);

/// The source deformed onto the target, with the source's connectivity (H'_a).
struct SurfaceFit {
  Points vertices;  ///< 3×n, source frame, mesh units
  std::vector<double>
      confidence;  ///< n, in [0, 1]: 0 where a vertex was moved without a counterpart of its own
  SurfaceFitSummary summary;
};

/// What the surface fitting works on, all in the source frame, mesh units.
struct SurfaceFitInput {
  const TriangleMesh& source;
  const Points& warped_vertices;          ///< 3×n: the source's vertices after the coarse warp Ẽ
  const TriangleMesh& target;             ///< H'_b, the target in the source frame
  const Points& anchor_sources;           ///< 3×k
  const Points& anchor_targets;           ///< 3×k
  const Eigen::VectorXd& anchor_weights;  ///< k
  /// k, ≥ 0, mesh units: accuracies. Empty is 0 for all; where it is 0 the weight says how much an anchor
  /// counts. The deformation graph goes by it, the laplacian fit by the weights alone.
  Eigen::VectorXd anchor_sigmas = {};
  /// Both, or neither: a vertex of the source is drawn only to its own patch of the target, and by it, and
  /// what is excluded attracts nothing. The deformation graph only.
  FacePatches source_patches = {};
  FacePatches target_patches = {};
  std::vector<char> anchor_tested = {};  ///< k: whether it may be an outlier; empty: none may
};

/// A target whose faces are oriented against the source's, as of a file that is inside out, is flipped
/// first, and the summary says so; where both look out of what they enclose, one is a mirror image of the
/// other. Throws InvalidInput for that, for unusable meshes, sizes that differ and patches that the method
/// does not know, SolverError when the factorisation fails.
SurfaceFit fit_surface(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                       const Progress& progress = {});

}  // namespace bespoke
