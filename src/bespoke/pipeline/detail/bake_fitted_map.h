#pragma once

#include "bespoke/bake/bake.h"
#include "bespoke/pipeline/detail/bake_steps.h"
#include "bespoke/pipeline/fit_mapping.h"

namespace bespoke {

/// Bakes the elastic map of `fit`, and makes it another one where its bake does not do: a step that folds
/// although it was repaired becomes two, a chain of many such steps one of more equal ones, and guides of one
/// step that take it beyond its share of voxels are left. `options` are those of the fit, `anchors` and
/// `source` its own. Throws as fit_mapping and bake.
BakedSteps bake_fitted_map(FittedMapping& fit, const TriangleMesh& source, const Anchors& anchors,
                           const FitOptions& options, const BakeOptions& bake, const Progress& progress = {});

}  // namespace bespoke
