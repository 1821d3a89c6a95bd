#pragma once

#include <string>

#include "bespoke/asset/asset.h"

namespace bespoke {

/// The source of an asset from the front, drawn from its distance field: a square PNG of `size` pixels as a
/// data URI, for pages and JSON. The same asset gives the same bytes. Throws InvalidInput for an asset
/// without previews.
std::string source_thumbnail(const Asset& asset, int size);

}  // namespace bespoke
