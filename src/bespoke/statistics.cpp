#include "bespoke/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bespoke/error.h"

namespace bespoke {

Statistics summarize(std::vector<double> values) {
  if (values.empty()) return {};
  for (const double value : values)
    if (!std::isfinite(value)) throw InvalidInput("statistics of a value that is not finite");
  std::sort(values.begin(), values.end());
  const auto nearest_rank = [&](double fraction) {
    const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(values.size())));
    return values[std::max<std::size_t>(rank, 1) - 1];
  };
  return {values.size(),      values.front(),     nearest_rank(0.5),
          nearest_rank(0.95), nearest_rank(0.99), values.back()};
}

std::string to_string(const Statistics& statistics) {
  char text[200];
  std::snprintf(text, sizeof text, "min %.4g median %.4g p95 %.4g p99 %.4g max %.4g (n = %zu)",
                statistics.min, statistics.median, statistics.p95, statistics.p99, statistics.max,
                statistics.count);
  return text;
}

}  // namespace bespoke
