#pragma once

#include <memory>
#include <string>

#include "bespoke/asset/asset.h"
#include "bespoke/mapping/elastic_map.h"

namespace bespoke::command {

/// The exact map that `fit --keep-exact` stored in the asset read from `path`. Throws InvalidInput when there
/// is none, FormatError for bytes that are not one.
std::shared_ptr<const ElasticMap> stored_exact_map(const std::string& path, const Asset& asset);

}  // namespace bespoke::command
