#include "bespoke/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {
namespace {

void require_finite(const std::vector<double>& values) {
  for (const double value : values)
    if (!std::isfinite(value)) throw InvalidInput("statistics of a value that is not finite");
}

/// Of the nearest rank, from 0.
std::size_t place_of(double fraction, std::size_t count) {
  const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(count)));
  return std::max<std::size_t>(rank, 1) - 1;
}

}  // namespace

std::vector<double> sorted_finite(std::vector<double> values) {
  require_finite(values);
  std::sort(values.begin(), values.end());
  return values;
}

double nearest_rank(const std::vector<double>& sorted, double fraction) {
  return sorted[place_of(fraction, sorted.size())];
}

Statistics summarize(std::vector<double> values) {
  if (values.empty()) return {};
  require_finite(values);
  // Ranks ascend, and what is below one is not looked at again: a part of the time of sorting.
  auto rest = values.begin();
  const auto next = [&](double fraction) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(place_of(fraction, values.size()));
    std::nth_element(rest, at, values.end());
    rest = at;
    return *at;
  };
  return {values.size(), next(0), next(0.5), next(0.95), next(0.99), next(1)};
}

std::string to_string(const Statistics& statistics) {
  char text[200];
  std::snprintf(text, sizeof text, "min %.4g median %.4g p95 %.4g p99 %.4g max %.4g (n = %zu)",
                statistics.min, statistics.median, statistics.p95, statistics.p99, statistics.max,
                statistics.count);
  return text;
}

}  // namespace bespoke
