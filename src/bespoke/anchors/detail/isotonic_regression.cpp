#include "bespoke/anchors/detail/isotonic_regression.h"

#include <algorithm>
#include <cstddef>

namespace bespoke {
namespace {

/// Values between two fixed ones, by pooling adjacent violators (Ayer et al. 1955): the nearest rising
/// sequence within bounds is the nearest one, clamped.
void append_rising(const SlidingValue* begin, const SlidingValue* end, double low, double high,
                   std::vector<double>& rising) {
  struct Pool {
    double sum;
    std::size_t count;
    double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<Pool> pools;
  for (; begin != end; ++begin) {
    pools.push_back({begin->value, 1});
    while (pools.size() > 1 && pools.back().mean() < pools[pools.size() - 2].mean()) {
      const Pool last = pools.back();
      pools.pop_back();
      pools.back().sum += last.sum;
      pools.back().count += last.count;
    }
  }
  for (const Pool& pool : pools) rising.insert(rising.end(), pool.count, std::clamp(pool.mean(), low, high));
}

}  // namespace

std::vector<double> nearest_rising(const std::vector<SlidingValue>& values, double low, double high) {
  std::vector<double> rising;
  const SlidingValue* const last = values.data() + values.size();
  for (const SlidingValue* begin = values.data(); begin != last;) {
    const SlidingValue* end = std::find_if(begin, last, [](const SlidingValue& v) { return v.is_fixed; });
    append_rising(begin, end, low, end == last ? high : end->value, rising);
    if (end == last) break;
    low = end->value;
    rising.push_back(low);
    begin = end + 1;
  }
  return rising;
}

std::vector<double> nearest_rising_round(const std::vector<SlidingValue>& values, double turn) {
  // Pools do not reach round the curve: between turns before and behind, the middle one has no ends.
  std::vector<SlidingValue> turns;
  for (const double shift : {-turn, 0.0, turn})
    for (const SlidingValue& value : values) turns.push_back({value.value + shift, value.is_fixed});
  const std::vector<double> rising = nearest_rising(turns);
  const auto middle = rising.begin() + static_cast<std::ptrdiff_t>(values.size());
  return {middle, middle + static_cast<std::ptrdiff_t>(values.size())};
}

}  // namespace bespoke
