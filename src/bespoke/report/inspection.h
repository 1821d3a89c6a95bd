#pragma once

#include <string>

#include "bespoke/asset/asset.h"

namespace bespoke {

/// What an asset says about itself, as lines for a person.
std::string inspection_text(const Asset& asset);

/// The same as a JSON object: direction, unit, R, T, a₀, A, methods, lengths, errors, certificate, levels,
/// anchors, models, options and stages.
std::string inspection_json(const Asset& asset);

}  // namespace bespoke
