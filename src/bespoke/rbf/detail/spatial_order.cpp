#include "bespoke/rbf/detail/spatial_order.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// A key has 30 bits: three passes of the sort below.
constexpr int bits_per_axis = 10;

/// Spreads the low 10 bits to every third bit.
std::uint32_t spread(std::uint32_t value) {
  value = (value | (value << 16)) & 0x030000FFu;
  value = (value | (value << 8)) & 0x0300F00Fu;
  value = (value | (value << 4)) & 0x030C30C3u;
  value = (value | (value << 2)) & 0x09249249u;
  return value;
}

struct Keyed {
  std::uint32_t key;
  int index;
};

/// Radix sort by key; equal keys keep their order.
void sort_by_key(std::vector<Keyed>& keyed) {
  constexpr int digit_bits = 10;
  constexpr std::uint32_t digits = 1u << digit_bits;
  std::vector<Keyed> sorted(keyed.size());
  for (int shift = 0; shift < 3 * bits_per_axis; shift += digit_bits) {
    const auto digit_of = [&](const Keyed& item) { return (item.key >> shift) & (digits - 1); };
    std::array<std::size_t, digits> place{};
    for (const Keyed& item : keyed) ++place[digit_of(item)];
    std::exclusive_scan(place.begin(), place.end(), place.begin(), std::size_t{0});
    for (const Keyed& item : keyed) sorted[place[digit_of(item)]++] = item;
    keyed.swap(sorted);
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
      std::uint32_t key = 0;
      if (point.allFinite() && scale > 0)
        for (int axis = 0; axis < 3; ++axis)
          key |= spread(static_cast<std::uint32_t>((point[axis] - box.min()[axis]) * scale)) << axis;
      keyed[i] = {key, static_cast<int>(i)};
    }
  });
  sort_by_key(keyed);
  std::vector<int> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = keyed[i].index;
  return order;
}

}  // namespace bespoke
