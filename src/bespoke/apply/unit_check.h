#pragma once

#include <filesystem>
#include <string>

#include "bespoke/mapping/elastic_map.h"

namespace bespoke {

/// Refuses points (3×n) that look as if they were in another unit than the map: none of them is in its band,
/// or few of something larger than the model, but by the factor between two units nine in ten would be, as
/// large as what belongs around the model, whose box this is. Throws InvalidInput naming the factor; `name`
/// is that of the product. A few points lie so by chance, and a speck in the band may be a button: the same
/// is returned as a warning, otherwise nothing.
std::string require_unit_of_map(const std::string& name, const Points& points, const ElasticMap& elastic,
                                const Box& model);

}  // namespace bespoke
