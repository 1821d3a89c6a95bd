#pragma once

#include <vector>

#include "bespoke/registration/fit_summary.h"

namespace bespoke {

/// What summaries list of vertices, by other numbers: one a vertex.
RegistrationSummary renumbered(RegistrationSummary summary, const std::vector<int>& numbers);
ElasticSummary renumbered(ElasticSummary summary, const std::vector<int>& numbers);

}  // namespace bespoke
