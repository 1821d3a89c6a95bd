#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/anchors/patch_faces.h"
#include "bespoke/enum_names.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/progress.h"
#include "bespoke/statistics.h"
#include "bespoke/surface_fit/surface_fit_methods.h"

namespace bespoke {

/// What an open boundary of the source does where the target is open too.
enum class BoundaryRule {
  automatic,  ///< meets the target's boundary where both are plausibly the same cut (detail/boundary_match.h)
  free,       ///< goes where the surface around it goes: for models that were cut at different places
  matched,    ///< meets the target's boundary
};

inline constexpr std::array boundary_rules{Named<BoundaryRule>{"auto", BoundaryRule::automatic},
                                           Named<BoundaryRule>{"free", BoundaryRule::free},
                                           Named<BoundaryRule>{"matched", BoundaryRule::matched}};

/// What the laplacian fit adds to Eq. 11–15 for real meshes. All false is the printed method.
struct LaplacianAdditions {
  /// s of Eq. 11 grows with the number of vertices, so that displacements spread over the same distance at
  /// any resolution; else it is 1.
  bool scaled_stiffness = true;
  bool refuse_boundary = true;  ///< a point on the target's boundary is no counterpart
  /// A vertex without counterpart follows its neighbours (its term of Eq. 11 is left out); else its T⁰ is
  /// zero.
  bool free_unmatched = true;
  bool hold_anchors =
      true;  ///< anchors on both surfaces have terms in Eq. 11; else the warp alone knows them
  /// Stop when a step falls below ε or ‖T⁰‖ no longer falls; else only when ‖T⁰‖ ≤ ε.
  bool stop_at_rest = true;
  bool undo_turning_snaps = true;  ///< a vertex whose snap turns a face over stays where it was
};

inline constexpr LaplacianAdditions no_additions{false, false, false, false, false, false};

struct SurfaceFitOptions {
  SurfaceFitMethod method = SurfaceFitMethod::deformation_graph;
  /// Models are repaired first: seams are joined (seams.h, by who calls fit_surface), and a target that is
  /// inside out is flipped. Not part of the printed method.
  bool repair_models = true;
  int max_iterations = 100;  ///< laplacian only: deformation-graph runs a fixed schedule
  /// ε of the paper, a fraction of the source's bounding-box diagonal, in powers of two as large as the
  /// target.
  double epsilon = 1e-5;
  /// s of Eq. 11 as DisplacementSmoother writes it, ≥ 0, no unit, instead of the printed or the scaled one:
  /// how much smoothness counts against reaching the target in one step (laplacian only).
  std::optional<double> stiffness;
  LaplacianAdditions laplacian;
  BoundaryRule boundaries = BoundaryRule::automatic;  ///< deformation-graph only
  /// > 1, deformation-graph only: where a length on the surface would grow or shrink by a larger factor
  /// against the coarse deformation, the vertices follow their neighbours instead of being drawn.
  double max_stretch = 10;
  /// deformation-graph only: little strain says that the models are nearly one (SurfaceFitSummary::rigidity).
  /// Not so where no anchor holds the surface, for it slides to where it strains least.
  bool tell_rigidity = true;
};

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
  std::size_t off_surface_anchors = 0;  ///< too far from the source's surface to say where it goes
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

  /// How many times as large the target is (power_of_two_scale, length.h), by the warp.
  double size_scale() const;
};

/// A target whose faces are oriented against the source's, as of a file that is inside out, is flipped
/// first, and the summary says so; where both look out of what they enclose, one is a mirror image of the
/// other. Throws InvalidInput for that, for unusable meshes, sizes that differ and patches that the method
/// does not know, SolverError when the factorisation fails.
SurfaceFit fit_surface(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                       const Progress& progress = {});

}  // namespace bespoke
