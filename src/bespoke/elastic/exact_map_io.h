#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "bespoke/mapping/elastic_map.h"

namespace bespoke {

/// The bytes of an exact elastic map, so that an asset can carry it beside its grids (`--keep-exact`) and
/// anybody can measure what baking cost. Little-endian: magic, version, type (elastic_methods.h), then what
/// its constructor takes, all numbers as doubles or 32/64-bit integers. The same map gives the same bytes.
/// Of a chain of several steps: another magic, their number, and of each its length and bytes. Throws
/// InvalidInput for a map of any other type (a baked one, for instance).
std::string serialize_exact_map(const ElasticMap& map);

/// The map again: displacement and gradient have the same bits as before. Throws FormatError for bytes that
/// serialize_exact_map did not write, before any size in them is trusted.
std::shared_ptr<const ElasticMap> parse_exact_map(std::string_view bytes);

}  // namespace bespoke
