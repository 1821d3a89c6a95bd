#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "bespoke/mapping/elastic_chain.h"
#include "bespoke/pipeline/elastic_steps.h"
#include "bespoke/registration/registration.h"

namespace bespoke {

/// Everything the fit found, of all vertices of the source; Ψ = Γ∘E.
struct FittedMapping {
  RigidTransform target_from_source;            ///< Γ
  std::shared_ptr<const ElasticChain> elastic;  ///< E, of one step for models in about the same pose
  std::vector<Points> step_sources;     ///< 3×n per step, where the source's vertices are when it begins
  Points fitted_vertices;               ///< H'_a, 3×n, source frame, mesh units, parts separated
  std::vector<double> confidence;       ///< of the surface fitting, n (surface_fit.h); empty without
  std::vector<double> anchor_residual;  ///< |Γ(E(q)) − q'|, mesh units, one per pair
  std::vector<double> anchor_sigma;     ///< as the fit took it, mesh units, one per pair; empty without
  FitSummary summary;
  std::optional<StepPlan> plan;  ///< of a chain whose steps follow a path; empty for others, and for one step
};

/// Section IV as a whole: the registration (registration.h), and E of it: rigid part, coarse warp, surface
/// fit, elastic map. Exact anchors off the surface are points of E's own (not of p-FFD). Vertices of loose
/// parts lie where the map takes them, and have no confidence. Throws InvalidInput, SolverError (also for an
/// uncertain alignment), MemoryLimitError.
FittedMapping fit_mapping(const Problem& problem, const FitOptions& options, const Progress& progress = {});

}  // namespace bespoke
