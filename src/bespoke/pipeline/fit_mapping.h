#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/mapping/elastic_chain.h"
#include "bespoke/mesh/mesh_components.h"
#include "bespoke/pipeline/elastic_steps.h"
#include "bespoke/pipeline/fit_options.h"
#include "bespoke/pipeline/fit_summary.h"
#include "bespoke/pipeline/problem.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// Everything the fit found; Ψ = Γ∘E.
struct FittedMapping {
  RigidTransform target_from_source;            ///< Γ
  std::shared_ptr<const ElasticChain> elastic;  ///< E, of one step for models in about the same pose
  std::vector<Points> step_sources;     ///< 3×n per step, where the source's vertices are when it begins
  Points fitted_vertices;               ///< H'_a, 3×n, source frame, mesh units, parts separated
  std::vector<double> confidence;       ///< of the surface fitting, n (surface_fit.h); empty without
  std::vector<double> anchor_residual;  ///< |Γ(E(q)) − q'|, mesh units, one per pair
  std::vector<double> anchor_sigma;     ///< as the fit took it, mesh units, one per pair; empty without
  FitSummary summary;
  ElasticPairs pairs;            ///< what E was fitted to
  std::optional<StepPlan> plan;  ///< of a chain whose steps follow a path; empty for others, and for one step
  /// The parts of the source that have a counterpart; empty for all. What is said above of the source and its
  /// vertices is then said of this mesh.
  std::shared_ptr<const PartialMesh> registered;
};

/// What the map was fitted to: the source, or its registered parts.
const TriangleMesh& registered_source(const FittedMapping& fit, const TriangleMesh& source);

/// The same of all vertices of the source: those of loose parts lie where the map takes them, and have no
/// confidence.
FittedMapping with_loose_parts(FittedMapping fit, const TriangleMesh& source);

/// Section IV as a whole: rigid part, coarse warp, surface fit, elastic map. Anchors without weight and σ get
/// a σ first, outliers are left out (anchor_accuracy.h); exact ones off the surface are points of E's own
/// (not of p-FFD); without anchors the surfaces are aligned (fit_unanchored.h). Loose parts without a
/// counterpart (registered_parts.h) are left out. Curves and borders of patches take a further surface fit.
/// Throws InvalidInput, SolverError (also for an uncertain alignment), MemoryLimitError.
FittedMapping fit_mapping(const TriangleMesh& source, const TriangleMesh& target, const Anchors& anchors,
                          const FitOptions& options, const Progress& progress = {});

/// The registration alone, sections IV.A to IV.C: everything but E and what follows from it.
/// Throws as fit_mapping.
FittedMapping fit_source_surface(const TriangleMesh& source, const TriangleMesh& target,
                                 const Anchors& anchors, const FitOptions& options,
                                 const Progress& progress = {});

/// The same for a source that is already registered: `fitted` has the source's connectivity and lies on the
/// target, in the target frame (the consistent-connectivity case of the paper's references 4–7). Anchors may
/// be empty: then all vertices serve as anchors of the rigid part.
FittedMapping fit_mapping_to_fitted(const TriangleMesh& source, const TriangleMesh& fitted,
                                    const Anchors& anchors, const FitOptions& options,
                                    const Progress& progress = {});

/// That the fitted source has the source's vertices and faces; `what` names it in the message. Throws
/// InvalidInput.
void require_same_connectivity(const TriangleMesh& source, const TriangleMesh& fitted,
                               const std::string& what);

}  // namespace bespoke
