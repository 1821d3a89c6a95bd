#pragma once

#include <array>
#include <optional>

#include "bespoke/enum_names.h"

namespace bespoke {

enum class SurfaceFitMethod {
  laplacian,          ///< the paper's (IV.C, Eq. 11–15)
  deformation_graph,  ///< nodes on the source and layers of space, coarse to fine
};

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
  /// ε of the paper, a fraction of the source's bounding-box diagonal, scaled as the warp scales it.
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

}  // namespace bespoke
