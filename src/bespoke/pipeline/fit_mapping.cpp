#include "bespoke/pipeline/fit_mapping.h"

#include "bespoke/pipeline/detail/fit_map.h"
#include "bespoke/pipeline/detail/unusable_fit.h"
#include "bespoke/pipeline/detail/whole_fit.h"

namespace bespoke {

FittedMapping fit_mapping(const Problem& problem, const FitOptions& options, const Progress& progress) {
  const Registration registration = register_models(problem, options, progress);
  const MapFit fit = fit_map(
      map_problem(registered_mesh(registration, problem.source), registration, options), options, progress);
  if (!problem.fitted)
    require_met_anchors(problem.anchors, anchor_residuals(fit, registration, problem.anchors), options);
  return whole_fit(problem, registration, fit, map_findings(problem, registration, fit, options));
}

}  // namespace bespoke
