#pragma once

#include <limits>
#include <vector>

namespace bespoke {

/// A value of a sequence that should rise.
struct SlidingValue {
  double value = 0;
  bool is_fixed = false;  ///< those that are rise already
};

/// The rising sequence nearest to this one by the sum of squares (isotonic regression, by pooling neighbours
/// that fall; Barlow and others 1972), from `low` to `high`, in which fixed values, that lie between, stay.
/// Neighbours may become equal.
std::vector<double> nearest_rising(const std::vector<SlidingValue>& values,
                                   double low = -std::numeric_limits<double>::infinity(),
                                   double high = std::numeric_limits<double>::infinity());

/// The same where the first value, raised by `turn`, follows the last.
std::vector<double> nearest_rising_round(const std::vector<SlidingValue>& values, double turn);

}  // namespace bespoke
