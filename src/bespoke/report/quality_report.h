#pragma once

#include <string>
#include <vector>

#include "bespoke/quality/mapping_quality.h"

namespace bespoke {

/// The measures as lines for a person; lengths in `unit` (for instance "cm", "unknown"). `names`: of the
/// products, in their order.
std::string quality_text(const MappingQuality& quality, const std::vector<std::string>& names,
                         const std::string& unit);

/// The same as a JSON object.
std::string quality_json(const MappingQuality& quality, const std::vector<std::string>& names,
                         const std::string& unit);

}  // namespace bespoke
