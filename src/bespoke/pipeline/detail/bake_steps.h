#pragma once

#include <vector>

#include "bespoke/asset/asset.h"
#include "bespoke/bake/bake.h"
#include "bespoke/mapping/elastic_chain.h"

namespace bespoke {

struct BakedSteps {
  std::vector<MapStep> steps;          ///< certified
  std::vector<BakeSummary> summaries;  ///< one per step
  BakeSummary whole;  ///< sums over the steps; the error is that of the whole map, measured on it
};

/// Adds a step's counts and levels to those of the whole; its error is not touched.
void add_step(const BakeSummary& step, BakeSummary& whole);

/// What is baked.
struct ExactSteps {
  const ElasticChain& chain;
  const std::vector<Points>& surfaces;  ///< 3×n a step, the source's vertices before it, mesh units
  const Faces& faces;                   ///< the source's
};

/// Bakes a chain, the last step first, so that the whole meets the tolerance: each step's error is measured
/// at the end of the chain; where the whole misses, all are baked again, finer. Steps share
/// BakeOptions::max_leaves.
BakedSteps bake_steps(const ExactSteps& exact, const BakeOptions& options, const Progress& progress = {});

}  // namespace bespoke
