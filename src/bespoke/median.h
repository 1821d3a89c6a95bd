#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace bespoke {

/// The middle one of the values, of which there must be some; of an even number the greater of two.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace bespoke
