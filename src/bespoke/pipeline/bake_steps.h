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

/// Bakes every step of a chain so that the whole meets the tolerance, the last one first: errors add up along
/// a chain and later steps may magnify those of earlier ones, so that each step's are measured at the end of
/// the chain, and held against a fraction of the tolerance. Then the whole is measured; where it misses the
/// tolerance although every step met its own, all are baked once more, finer by what was missed. surfaces:
/// 3×n per step, where the source's vertices are when it begins; faces: the source's. One step is baked as
/// bake does. divisible: where not empty, whether a step may be divided, one per step; one of these that
/// folds ends the baking, and the result holds it and the steps after it only. done: last steps of the
/// chain as they were baked before, taken as they are. The steps share BakeOptions::max_leaves; where
/// dividing left one less than half of an even share, all are baked once more.
BakedSteps bake_steps(const ElasticChain& exact, const std::vector<Points>& surfaces, const Faces& faces,
                      const BakeOptions& options, const std::vector<bool>& divisible = {},
                      BakedSteps done = {}, const Progress& progress = {});

}  // namespace bespoke
