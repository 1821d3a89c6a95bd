#pragma once

#include "bespoke/alignment/align_models.h"
#include "bespoke/alignment/placement.h"
#include "bespoke/rigid/rigid_transform.h"
#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {

/// How the two surfaces alone were brought together.
struct UnanchoredSummary {
  AlignmentSummary alignment;
  PlacementFigures placement;  ///< of the fitted source
  bool from_deformed = false;  ///< the fit began at the coarse deformation, else at the similarity
  /// The fit was led by what the fits of either surface onto the other agree on.
  bool of_both_directions = false;
  double disagreement = 0;  ///< median distance between these two, fraction of the target's diagonal
  double seconds = 0;       ///< all but the fit that was taken
};

/// One line.
std::string to_string(const UnanchoredSummary& summary);

/// The source registered to the target without anchors.
struct UnanchoredFit {
  RigidTransform target_from_source;  ///< Γ, of all vertices
  Points start;                       ///< 3×n, the coarse deformation, source frame, mesh units
  SurfaceFit surface;                 ///< source frame, mesh units
  UnanchoredSummary summary;
};

/// Aligns the models (align_models.h), then fits the surface from the similarity and from the coarse
/// deformation; from the better of these the target is fitted to the source as well, and what the two
/// directions agree on leads a third fit. The fit with the lowest misfit (placement.h) is taken. Throws
/// SolverError, saying what to do, unless the alignment is certain and the fitted source covers the target.
UnanchoredFit fit_unanchored(const TriangleMesh& source, const TriangleMesh& target,
                             const SurfaceFitOptions& options, const Progress& progress = {});

}  // namespace bespoke
