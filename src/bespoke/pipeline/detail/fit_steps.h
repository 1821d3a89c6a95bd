#pragma once

#include "bespoke/pipeline/detail/map_fit.h"

namespace bespoke {

/// How many steps are fitted, and how.
struct StepRequest {
  int count = 1;
  RegionalMotion motion;  ///< of the fitted source, as far as it is known: a path knows more
  /// Steps of a chain that finite elements are held up in (StepMethod) are halved once; a single one is given
  /// up.
  bool halve_blocked = false;
};

/// The elastic map as a chain of so many steps along surfaces between the two, or as one. Where the number is
/// not given (FitOptions::steps) it may be larger, if the path turns farther than the request knows. Throws
/// as fit_map.
MapFit fit_steps(const MapProblem& problem, const FitOptions& options, const StepRequest& request,
                 const Progress& progress);

/// The fit with these steps for its own.
MapFit with_steps(MapFit fit, ElasticSteps steps);

/// The fit with its residuals, which can be measured only with the whole map at hand.
MapFit measured(MapFit fit, const MapProblem& problem, const FitOptions& options);

/// Of a map that is all there is, or of the steps of a chain.
ElasticOptions elastic_options(const FitOptions& options, bool of_steps);

FitOptions without_guides(FitOptions options);

/// By how much a vertex may be missed before it is listed, mesh units.
double met_within(const FitOptions& options);

/// Whether no more than one vertex in twenty is missed.
bool follows_fit(const MapFit& fit, const FitOptions& options);

}  // namespace bespoke
