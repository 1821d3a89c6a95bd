#pragma once

#include <limits>
#include <numbers>

#include "bespoke/types.h"

namespace bespoke::test {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double degree = std::numbers::pi / 180;

inline double largest_distance(const Points& a, const Points& b) {
  return (a - b).colwise().norm().maxCoeff();
}

}  // namespace bespoke::test
