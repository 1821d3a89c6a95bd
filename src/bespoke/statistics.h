#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace bespoke {

/// Order statistics of a sample of magnitudes, in the sample's unit. All zero when `count` is 0.
struct Statistics {
  std::size_t count = 0;
  double min = 0;
  double median = 0;
  double p95 = 0;
  double p99 = 0;
  double max = 0;
};

/// Ascending. Throws InvalidInput on a non-finite value.
std::vector<double> sorted_finite(std::vector<double> values);

/// The smallest value that at least `fraction` of the ascending values, not none, do not exceed.
double nearest_rank(const std::vector<double>& sorted, double fraction);

/// Nearest-rank percentiles: every reported value is one of the sample. Throws InvalidInput on a non-finite
/// value.
Statistics summarize(std::vector<double> values);

/// "min 0.1 median 0.2 p95 0.3 p99 0.4 max 0.5 (n = 10)", four significant digits.
std::string to_string(const Statistics& statistics);

}  // namespace bespoke
