#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/elastic_map.h"

namespace bespoke {

/// At about so many places `fit` and `info` look.
inline constexpr std::size_t determinant_samples = 200'000;

/// The least det ∇E at about `count` places of the leaves of these pyramids, as many on each level, the same
/// each time; that of the affine part for pyramids without leaves. Of a chain, with the pyramids of its
/// steps, it is an estimate from above, where the product of the steps' proved bounds is far below what any
/// place has. No unit.
double sampled_min_determinant(const ElasticMap& map, const std::vector<const Pyramid*>& pyramids,
                               std::size_t count = determinant_samples);

}  // namespace bespoke
