#pragma once

#include <optional>

#include "bespoke/pipeline/detail/map_fit.h"

namespace bespoke {

/// E of the fitted vertices, the parts of which are separated (IV.D, IV.E): one map for models in about the
/// same pose, else a chain of them along surfaces between the two. Throws InvalidInput, SolverError (also
/// where no useful map follows from a registration), MemoryLimitError.
MapFit fit_map(const MapProblem& problem, const FitOptions& options, const Progress& progress = {});

/// The same surfaces with a map that meets these alone, or nothing if guides in space did not shape `fit`.
/// Options as before.
std::optional<MapFit> refitted_without_guides(const MapFit& fit, const MapProblem& problem,
                                              const FitOptions& options, const Progress& progress = {});

}  // namespace bespoke
