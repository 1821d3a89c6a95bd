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
  slots_.assign(1, {});
  if (count == 0) return;
  origin_ = points.rowwise().minCoeff();
  const Vector3 extent = points.rowwise().maxCoeff() - origin_;
  const double edge = std::max(cell, extent.maxCoeff() / max_cells);
  inverse_cell_ = 1 / edge;
  cells_ = (extent.array() * inverse_cell_).floor().min(max_cells).cast<int>() + 1;

  std::vector<std::pair<std::uint64_t, int>> keyed(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const Cell cell_index = cell_of(points.col(column)).min(cells_ - 1);
    keyed[i] = {key_of(cell_index.x(), cell_index.y(), cell_index.z()), static_cast<int>(i)};
  }
  std::sort(keyed.begin(), keyed.end());

  sorted_.resize(3, points.cols());
  order_.resize(count);
  std::vector<Slot> occupied;
  for (std::size_t position = 0; position < count; ++position) {
    const auto [key, index] = keyed[position];
    order_[position] = index;
    sorted_.col(static_cast<Eigen::Index>(position)) = points.col(index);
    if (occupied.empty() || occupied.back().key != key)
      occupied.push_back({key, static_cast<int>(position), static_cast<int>(position)});
    ++occupied.back().end;
  }

  std::size_t slot_count = 4;
  while (slot_count < 2 * occupied.size()) slot_count *= 2;
  slots_.assign(slot_count, {});
  for (const Slot& cell_range : occupied) {
    std::size_t slot = first_slot(cell_range.key);
    while (slots_[slot].begin < slots_[slot].end) slot = next_slot(slot);
    slots_[slot] = cell_range;
  }
}

PointGrid::Cell PointGrid::cell_of(const Vector3& x) const {
  // Clamped before the conversion: a far or infinite coordinate has no int.
  const Eigen::Array3d cell = ((x - origin_).array() * inverse_cell_).floor();
  return cell.max(-1).min(cells_.cast<double>()).cast<int>();
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
