#include "bespoke/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {

std::vector<double> sorted_finite(std::vector<double> values) {
  for (const double value : values)
    if (!std::isfinite(value)) throw InvalidInput("statistics of a value that is not finite");
  std::sort(values.begin(), values.end());
  return values;
}

double nearest_rank(const std::vector<double>& sorted, double fraction) {
  const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

Statistics summarize(std::vector<double> values) {
  if (values.empty()) return {};
  const std::vector<double> sorted = sorted_finite(std::move(values));
  return {sorted.size(),
          sorted.front(),
          nearest_rank(sorted, 0.5),
          nearest_rank(sorted, 0.95),
          nearest_rank(sorted, 0.99),
          sorted.back()};
}

std::string to_string(const Statistics& statistics) {
  char text[200];
  std::snprintf(text, sizeof text, "min %.4g median %.4g p95 %.4g p99 %.4g max %.4g (n = %zu)",
                statistics.min, statistics.median, statistics.p95, statistics.p99, statistics.max,
                statistics.count);
  return text;
}

}  // namespace bespoke
