#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "bespoke/mapping/elastic_chain.h"
#include "bespoke/pipeline/elastic_steps.h"
#include "bespoke/registration/elastic_pairs.h"
#include "bespoke/registration/fit_options.h"
#include "bespoke/registration/registration.h"

namespace bespoke {

/// What E is fitted to. Refers to what it was made of.
struct MapProblem {
  const TriangleMesh& source;        ///< its registered parts
  const Registration& registration;  ///< of it: H'_a and Γ
  ElasticPairs pairs;
  std::size_t anchors_off_surface =
      0;  ///< that the surface does not carry, whether the method meets them or not
};

/// With the registration's anchors, of which exact ones off the surface are points of E's own where the
/// method meets points.
MapProblem map_problem(const TriangleMesh& source, const Registration& registration,
                       const FitOptions& options);

/// E, and what was found of it.
struct MapFit {
  std::shared_ptr<const ElasticChain> elastic;  ///< E, of one step for models in about the same pose
  std::vector<Points>
      step_sources;  ///< 3×n per step, where the source's vertices are when it begins, mesh units
  std::optional<StepPlan> plan;  ///< of a chain whose steps follow a path
  ElasticSummary summary;
};

/// |Γ(E(q)) − q'|, mesh units, one per pair.
std::vector<double> anchor_residuals(const MapFit& fit, const Registration& registration,
                                     const Anchors& anchors);

}  // namespace bespoke
