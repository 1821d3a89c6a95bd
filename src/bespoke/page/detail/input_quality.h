#pragma once

#include <string>
#include <vector>

#include "bespoke/mapping/elastic_chain.h"
#include "bespoke/page/view_scene.h"

namespace bespoke {

/// What `measure` finds of a map and its products. `chain`: the map's, loaded.
MappingQuality input_quality(const ViewInput& input, const ElasticChain& chain, const Progress& progress);

/// In their order.
std::vector<std::string> product_names(const ViewInput& input);

}  // namespace bespoke
