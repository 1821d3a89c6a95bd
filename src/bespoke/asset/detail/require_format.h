#pragma once

#include <string>

#include "bespoke/error.h"

namespace bespoke {

/// Throws FormatError(what) unless it holds.
inline void require_format(bool holds, const std::string& what) {
  if (!holds) throw FormatError(what);
}

}  // namespace bespoke
