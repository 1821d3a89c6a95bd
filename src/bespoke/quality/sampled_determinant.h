#pragma once

#include <cstddef>

#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/elastic_map.h"

namespace bespoke {

/// The least det ∇E at `count` places of a pyramid's leaves, as many on each level, the same each time; that
/// of the affine part for a pyramid without leaves. Of a chain it is an estimate from above, where the
/// product of its steps' proved bounds is a bound far below what any place has. No unit.
double sampled_min_determinant(const ElasticMap& map, const Pyramid& pyramid, std::size_t count = 200'000);

}  // namespace bespoke
