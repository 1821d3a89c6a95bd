#pragma once

#include <memory>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/progress.h"
#include "bespoke/registration/fit_options.h"
#include "bespoke/registration/fit_summary.h"
#include "bespoke/registration/problem.h"
#include "bespoke/rigid/rigid_transform.h"
#include "bespoke/topology/mesh_components.h"

namespace bespoke {

/// The source registered to the target, sections IV.A to IV.C.
struct Registration {
  RigidTransform target_from_source;  ///< Γ
  Points fitted_vertices;             ///< H'_a, 3×n, source frame, mesh units
  std::vector<double> confidence;     ///< n (surface_fit.h); empty without
  std::vector<double> anchor_sigma;   ///< as the fit took it, mesh units, one per given pair; empty without
  Anchors anchors;                    ///< as the fit took them, those of curves included
  RegistrationSummary summary;
  /// The parts of the source that have a counterpart; empty for all. What is said above of the source and its
  /// vertices is then said of this mesh.
  std::shared_ptr<const PartialMesh> part;
};

/// What was registered: the source, or its registered parts.
const TriangleMesh& registered_mesh(const Registration& registration, const TriangleMesh& source);

/// H'_a in the target frame, 3×n.
Points registered_vertices(const Registration& registration);

/// Initial alignment, surface fit, parts separated. Anchors without weight and σ get a σ first, outliers are
/// left out (anchor_accuracy.h); without anchors the surfaces are aligned (fit_unanchored.h). Loose parts
/// without a counterpart (registered_parts.h) are left out. Curves and borders of patches take a further
/// surface fit. A source that is fitted already (Problem::fitted) gives Γ alone, by its vertices where there
/// are no anchors. Throws InvalidInput, SolverError (also for an uncertain alignment), MemoryLimitError.
Registration register_models(const Problem& problem, const FitOptions& options,
                             const Progress& progress = {});

/// The whole source, loose parts and parts that touch included. Throws as register_models.
Registration fit_source_surface(const Problem& problem, const FitOptions& options,
                                const Progress& progress = {});

/// That the fitted source has the source's vertices and faces; `what` names it in the message. Throws
/// InvalidInput.
void require_same_connectivity(const TriangleMesh& source, const TriangleMesh& fitted,
                               const std::string& what);

}  // namespace bespoke
