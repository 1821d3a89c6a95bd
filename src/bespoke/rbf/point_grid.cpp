#include "bespoke/rbf/point_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "bespoke/error.h"

namespace bespoke {
namespace {

// Two places of 21 bits fit a key; beyond that many cells the edge grows.
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
  rows_.assign(1, {});
  if (count == 0) return;
  origin_ = points.rowwise().minCoeff();
  const Vector3 extent = points.rowwise().maxCoeff() - origin_;
  const double edge = std::max(cell, extent.maxCoeff() / max_cells);
  inverse_cell_ = 1 / edge;
  cells_ = (extent.array() * inverse_cell_).floor().min(max_cells).cast<int>() + 1;

  using CellOfPoint = std::array<int, 4>;  // k, j, i, index of the point
  std::vector<CellOfPoint> placed(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Cell cell_index = cell_of(points.col(static_cast<Eigen::Index>(i))).min(cells_ - 1);
    placed[i] = {cell_index.z(), cell_index.y(), cell_index.x(), static_cast<int>(i)};
  }
  std::sort(placed.begin(), placed.end());

  sorted_.resize(3, points.cols());
  order_.resize(count);
  std::vector<Row> occupied;
  for (std::size_t position = 0; position < count; ++position) {
    const auto [k, j, i, index] = placed[position];
    order_[position] = index;
    sorted_.col(static_cast<Eigen::Index>(position)) = points.col(index);
    const auto cells = static_cast<int>(cell_place_.size());
    const bool begins_row = occupied.empty() || occupied.back().key != key_of(j, k);
    if (begins_row) occupied.push_back({key_of(j, k), cells, cells});
    if (!begins_row && cell_place_.back() == i) continue;
    cell_place_.push_back(i);
    cell_begin_.push_back(static_cast<int>(position));
    ++occupied.back().end;
  }
  cell_begin_.push_back(static_cast<int>(count));

  std::size_t slots = 4;
  while (slots < 2 * occupied.size()) slots *= 2;
  rows_.assign(slots, {});
  for (const Row& row : occupied) {
    std::size_t slot = first_slot(row.key);
    while (rows_[slot].begin < rows_[slot].end) slot = next_slot(slot);
    rows_[slot] = row;
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
