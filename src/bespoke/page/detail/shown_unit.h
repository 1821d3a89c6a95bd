#pragma once

#include <string>

#include "bespoke/asset/asset.h"

namespace bespoke {

/// The unit of a map's lengths as people read it: "cm", or "mesh units" where none was stated.
inline std::string shown_unit(const Asset& asset) {
  return asset.record.unit == "unknown" ? "mesh units" : asset.record.unit;
}

}  // namespace bespoke
