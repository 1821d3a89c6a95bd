#pragma once

#include <vector>

#include "bespoke/pipeline/detail/map_fit.h"
#include "bespoke/pipeline/fit_mapping.h"

namespace bespoke {

/// How well E meets what was given.
struct MapFindings {
  std::vector<MissedAnchor> missed;  ///< by more than their accuracy explains
  StretchedEdges stretched;          ///< beyond the options' bound
  std::vector<CurveSummary> curves;
  std::vector<PatchSummary> patches;
};

MapFindings map_findings(const Problem& problem, const Registration& registration, const MapFit& fit,
                         const FitOptions& options);

/// What all stages found, of all vertices of the source: those of loose parts lie where the map takes them,
/// and have no confidence.
FittedMapping whole_fit(const Problem& problem, const Registration& registration, const MapFit& fit,
                        const MapFindings& findings);

}  // namespace bespoke
