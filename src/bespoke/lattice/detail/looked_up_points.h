#pragma once

#include <cstddef>
#include <span>

#include "bespoke/types.h"

namespace bespoke {

/// What one task of a parallel look-up takes.
inline constexpr std::size_t points_per_chunk = 4096;

/// The coordinates of points, point after point.
inline std::span<const double> as_span(const Points& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}
inline std::span<double> as_span(Points& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

}  // namespace bespoke
