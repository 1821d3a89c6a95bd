#include "bespoke/rbf/spatial_order.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr int bits_per_axis = 16;

/// Spreads the low 16 bits to every third bit.
std::uint64_t spread(std::uint64_t value) {
  value = (value | (value << 16)) & 0x0000FF0000FFu;
  value = (value | (value << 8)) & 0x00F00F00F00Fu;
  value = (value | (value << 4)) & 0x0C30C30C30C3u;
  value = (value | (value << 2)) & 0x249249249249u;
  return value;
}

using Keyed = std::pair<std::uint64_t, int>;

/// Sorts chunks side by side, then merges neighbours in rounds.
void sort_in_parallel(std::vector<Keyed>& keyed) {
  constexpr std::size_t chunk = std::size_t{1} << 15;
  parallel_for(keyed.size(), chunk, [&](std::size_t begin, std::size_t end) {
    std::sort(keyed.begin() + std::ptrdiff_t(begin), keyed.begin() + std::ptrdiff_t(end));
  });
  std::vector<Keyed> merged(keyed.size() > chunk ? keyed.size() : 0);
  for (std::size_t width = chunk; width < keyed.size(); width *= 2) {
    parallel_for(keyed.size(), 2 * width, [&](std::size_t begin, std::size_t end) {
      const auto first = keyed.begin() + std::ptrdiff_t(begin);
      const auto middle = keyed.begin() + std::ptrdiff_t(std::min(begin + width, end));
      const auto last = keyed.begin() + std::ptrdiff_t(end);
      std::merge(first, middle, middle, last, merged.begin() + std::ptrdiff_t(begin));
    });
    keyed.swap(merged);
  }
}

}  // namespace

std::vector<int> spatial_order(const Points& x) {
  const auto count = static_cast<std::size_t>(x.cols());
  Box box;
  for (const Vector3 point : x.colwise())
    if (point.allFinite()) box.extend(point);
  const double extent = box.isEmpty() ? 0 : box.sizes().maxCoeff();
  const double largest = (1 << bits_per_axis) - 1;
  const double scale = extent > 0 && std::isfinite(extent) ? largest / extent : 0;

  std::vector<Keyed> keyed(count);
  parallel_for(count, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3 point = x.col(static_cast<Eigen::Index>(i));
      std::uint64_t key = 0;
      if (point.allFinite() && scale > 0)
        for (int axis = 0; axis < 3; ++axis)
          key |= spread(static_cast<std::uint64_t>((point[axis] - box.min()[axis]) * scale)) << axis;
      keyed[i] = {key, static_cast<int>(i)};
    }
  });
  sort_in_parallel(keyed);
  std::vector<int> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = keyed[i].second;
  return order;
}

}  // namespace bespoke
