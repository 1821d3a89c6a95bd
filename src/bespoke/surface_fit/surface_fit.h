#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/progress.h"
#include "bespoke/statistics.h"

namespace bespoke {

enum class SurfaceFitMethod {
  laplacian,   ///< the paper's (IV.C, Eq. 11–15)
  multiscale,  ///< smooth deformations, coarse to fine (multiscale_fit.h)
};

/// What an open boundary of the source does where the target is open too.
enum class BoundaryRule {
  automatic,  ///< meets the target's boundary where both are plausibly the same cut (boundary_match.h)
  free,       ///< goes where the surface around it goes: for models that were cut at different places
  matched,    ///< meets the target's boundary
};

struct SurfaceFitOptions {
  SurfaceFitMethod method = SurfaceFitMethod::multiscale;
  int max_iterations = 100;  ///< laplacian only: multiscale runs a fixed schedule
  /// ε of the paper: stop when the root mean square of a step falls below this fraction of the source's
  /// bounding-box diagonal.
  double epsilon = 1e-5;
  /// s of Eq. 11 as DisplacementSmoother writes it, ≥ 0, no unit: how much smoothness counts against reaching
  /// the target in one step (laplacian only). 1 is the printed equation. By default it grows with the number
  /// of vertices, so that displacements spread over the same distance at any resolution.
  std::optional<double> stiffness;
  BoundaryRule boundaries = BoundaryRule::automatic;  ///< multiscale only
};

enum class StopReason { converged, stagnated, iteration_cap };

const char* to_string(StopReason reason);

struct SurfaceFitSummary {
  Statistics before;  ///< distance of the warped source's vertices from the target surface, mesh units
  Statistics after;   ///< the same for the fitted source
  int iterations = 0;
  StopReason stop_reason = StopReason::iteration_cap;
  std::size_t unmatched_vertices =
      0;  ///< no compatible point in the last iteration: moved by the smoothness term alone
  bool similarity_suffices =
      false;                   ///< multiscale: one similarity explains the target, nothing else was fitted
  int matched_boundaries = 0;  ///< multiscale: open boundaries of the source taken for the target's cut
  std::size_t mended_vertices =
      0;  ///< multiscale: drawn to the wrong side of a fold, so they follow their neighbours
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
};

/// Throws InvalidInput for unusable meshes or sizes that differ, SolverError when the factorisation fails.
SurfaceFit fit_surface(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                       const Progress& progress = {});

}  // namespace bespoke
