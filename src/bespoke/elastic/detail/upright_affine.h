#pragma once

#include "bespoke/elastic/elastic_fit.h"
#include "bespoke/types.h"

namespace bespoke {

/// The affine part of the correspondences, 3×n each, mesh units. Throws InvalidInput where its determinant is
/// not above 0.
AffineMap upright_affine(const Points& sources, const Points& targets, AffinePart part);

}  // namespace bespoke
