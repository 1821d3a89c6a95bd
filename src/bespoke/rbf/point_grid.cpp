#include "bespoke/rbf/point_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {
namespace {

// 21 bits an axis fit a 64-bit key; beyond that many cells the edge grows.
constexpr int max_cells = 1 << 20;

std::uint64_t key_of(const Eigen::Array3i& cell) {
  return (static_cast<std::uint64_t>(cell.z()) << 42) | (static_cast<std::uint64_t>(cell.y()) << 21) |
         static_cast<std::uint64_t>(cell.x());
}

std::size_t slot_of(std::uint64_t key, std::size_t slots) {
  // Fibonacci hashing: the high bits of the product mix all bits of the key.
  return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15u) >> 20) & (slots - 1);
}

void require_usable(const Points& points, double length, const char* name) {
  if (!(length > 0) || !std::isfinite(length))
    throw InvalidInput(std::string(name) + " " + std::to_string(length) + " must be positive and finite");
  if (!points.allFinite()) throw InvalidInput("a point has a coordinate that is not finite");
  if (points.cols() > std::numeric_limits<int>::max())
    throw InvalidInput(std::to_string(points.cols()) + " points are more than this grid can index");
}

}  // namespace

PointGrid::PointGrid(const Points& points, double cell) {
  require_usable(points, cell, "cell edge");
  const auto count = static_cast<std::size_t>(points.cols());
  bucket_.assign(1, 0);
  cell_start_.assign(1, 0);
  if (count == 0) return;
  origin_ = points.rowwise().minCoeff();
  const Vector3 extent = points.rowwise().maxCoeff() - origin_;
  const double edge = std::max(cell, extent.maxCoeff() / max_cells);
  inverse_cell_ = 1 / edge;
  cells_ = (extent.array() * inverse_cell_).floor().min(max_cells).cast<int>() + 1;

  std::vector<std::pair<std::uint64_t, int>> keyed(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    keyed[i] = {key_of(cell_of(points.col(column)).min(cells_ - 1)), static_cast<int>(i)};
  }
  std::sort(keyed.begin(), keyed.end());

  sorted_.resize(3, points.cols());
  order_.resize(count);
  cell_start_.clear();
  for (std::size_t position = 0; position < count; ++position) {
    const auto [key, index] = keyed[position];
    order_[position] = index;
    sorted_.col(static_cast<Eigen::Index>(position)) = points.col(index);
    if (cell_keys_.empty() || cell_keys_.back() != key) {
      cell_keys_.push_back(key);
      cell_start_.push_back(static_cast<int>(position));
    }
  }
  cell_start_.push_back(static_cast<int>(count));

  std::size_t slots = 4;
  while (slots < 2 * cell_keys_.size()) slots *= 2;
  bucket_.assign(slots, 0);
  for (std::size_t occupied = 0; occupied < cell_keys_.size(); ++occupied) {
    std::size_t slot = slot_of(cell_keys_[occupied], slots);
    while (bucket_[slot] != 0) slot = (slot + 1) & (slots - 1);
    bucket_[slot] = static_cast<std::uint32_t>(occupied + 1);
  }
}

PointGrid::Cell PointGrid::cell_of(const Vector3& x) const {
  // Clamped before the conversion: a far or infinite coordinate has no int.
  const Eigen::Array3d cell = ((x - origin_).array() * inverse_cell_).floor();
  return cell.max(-1).min(cells_.cast<double>()).cast<int>();
}

PointGrid::Range PointGrid::range(const Cell& cell) const {
  const std::uint64_t key = key_of(cell);
  for (std::size_t slot = slot_of(key, bucket_.size()); bucket_[slot] != 0;
       slot = (slot + 1) & (bucket_.size() - 1)) {
    const std::size_t occupied = bucket_[slot] - 1;
    if (cell_keys_[occupied] == key) return {cell_start_[occupied], cell_start_[occupied + 1]};
  }
  return {};
}

std::vector<int> thin_points(const Points& points, double spacing) {
  require_usable(points, spacing, "spacing");
  const PointGrid grid(points, spacing);
  std::vector<char> covered(static_cast<std::size_t>(points.cols()), 0);
  std::vector<int> kept;
  for (int i = 0; i < points.cols(); ++i) {
    if (covered[static_cast<std::size_t>(i)]) continue;
    kept.push_back(i);
    grid.for_each_within(points.col(i), spacing, [&](int neighbour, double squared_distance) {
      if (squared_distance < spacing * spacing) covered[static_cast<std::size_t>(neighbour)] = 1;
    });
  }
  return kept;
}

}  // namespace bespoke
