#pragma once

#include "bespoke/pipeline/detail/bake_steps.h"
#include "bespoke/pipeline/detail/map_fit.h"
#include "bespoke/pipeline/make_map.h"

namespace bespoke {

/// A fit and its bake.
struct BakedFit {
  MapFit fit;
  BakedSteps baked;
};

/// Bakes `fit`, or another fit of the same problem where its bake does not do: a step that folds although it
/// was repaired becomes two, a chain of many such steps one of more equal ones, and guides of one step that
/// take it beyond its share of voxels are left. Options as those of the fit. Throws as fit_map and bake.
BakedFit bake_map(const MapFit& fit, const MapProblem& problem, const MakeMapOptions& options,
                  const Progress& progress = {});

}  // namespace bespoke
