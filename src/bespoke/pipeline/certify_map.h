#pragma once

#include "bespoke/asset/asset.h"

namespace bespoke {

/// What is proved about Ψ(t) of an asset, from its grids alone: of one step by its cells at t; of a chain
/// whose path is the flow by those of the steps that are over by then (at their ends) and of the one that is
/// under way (at its fraction). Throws InvalidInput for a chain on another path unless t is 0 or 1: straight
/// lines from x to E(x) are not made of steps.
Certificate certify_map(const Asset& asset, double t, const Progress& progress = {});

}  // namespace bespoke
