#pragma once

#include "bespoke/asset/asset.h"

namespace bespoke {

/// sampled_min_determinant (quality/sampled_determinant.h) of an asset's map, at places of all of its steps.
double sampled_min_determinant(const Asset& asset);

}  // namespace bespoke
