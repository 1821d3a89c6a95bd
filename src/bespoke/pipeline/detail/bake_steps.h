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

/// Whether the first of the last steps of a chain folds and may be divided. divisible: one per step of the
/// chain, or empty.
bool is_to_be_divided(const BakedSteps& baked, const std::vector<bool>& divisible);

/// Adds a step's counts and levels to those of the whole; its error is not touched.
void add_step(const BakeSummary& step, BakeSummary& whole);

/// What is baked.
struct ExactSteps {
  const ElasticChain& chain;
  const std::vector<Points>& surfaces;  ///< 3×n a step, the source's vertices before it, mesh units
  const Faces& faces;                   ///< the source's
};

/// A bake that may end early.
struct PartialBake {
  /// One a step, or empty: the first such step that folds ends the baking, and the result holds it and later
  /// ones only.
  std::vector<bool> divisible;
  BakedSteps done;  ///< last steps baked before
};

/// Bakes a chain, the last step first, so that the whole meets the tolerance: each step's error is measured
/// at the end of the chain; where the whole misses, all are baked again, finer. Steps share
/// BakeOptions::max_leaves; if one gets less than half of an even share, all are baked again.
BakedSteps bake_steps(const ExactSteps& exact, const BakeOptions& options, PartialBake partial = {},
                      const Progress& progress = {});

}  // namespace bespoke
