#include "bespoke/elastic/detail/nested_elements.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

namespace bespoke {
namespace {

/// What is a step of 0 or `sign` away along every axis, each once, in lexicographic order: merged, since a
/// step keeps the order.
std::vector<LatticeCoordinates> with_steps(std::vector<LatticeCoordinates> from, int sign) {
  from = unique_leaves(std::move(from));
  std::vector<LatticeCoordinates> shifted, merged;
  for (int axis = 0; axis < 3; ++axis) {
    shifted = from;
    for (LatticeCoordinates& each : shifted) each[static_cast<std::size_t>(axis)] += sign;
    merged.clear();
    std::set_union(from.begin(), from.end(), shifted.begin(), shifted.end(), std::back_inserter(merged));
    from.swap(merged);
  }
  return from;
}

/// The eight cells around each node.
std::vector<LatticeCoordinates> cells_around(const std::vector<LatticeCoordinates>& nodes) {
  return with_steps(nodes, -1);
}

std::vector<LatticeCoordinates> parents_of(std::vector<LatticeCoordinates> cells) {
  for (LatticeCoordinates& cell : cells) cell = parent_of(cell);
  return unique_leaves(std::move(cells));
}

}  // namespace

NestedElements::NestedElements(const Lattice& coarsest, std::vector<std::vector<LatticeCoordinates>> nodes)
    : origin_(coarsest.origin) {
  double voxel_size = coarsest.voxel_size;
  for (std::size_t k = 0; k < nodes.size(); ++k, voxel_size /= 2) {
    levels_.emplace_back();
    levels_.back().voxel_size = voxel_size;
  }
  split(nodes);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    ElementLevel& level = levels_[k];
    level.nodes = std::move(nodes[k]);
    level.first_unknown = unknowns_;
    unknowns_ += level.nodes.size();
    add_points(level, k == 0 ? nullptr : &levels_[k - 1]);
  }
}

void NestedElements::split(std::vector<std::vector<LatticeCoordinates>>& nodes) {
  nodes.back() = unique_leaves(std::move(nodes.back()));
  for (std::size_t k = nodes.size() - 1; k > 0; --k) {
    const std::vector<LatticeCoordinates> to_split = parents_of(cells_around(nodes[k]));
    for (const LatticeCoordinates& cell : to_split)
      for (int corner = 0; corner < 8; ++corner) nodes[k - 1].push_back(moved(cell, corner_step(corner)));
    nodes[k - 1] = unique_leaves(std::move(nodes[k - 1]));
    levels_[k].cells.reserve(8 * to_split.size());
    for (const LatticeCoordinates& cell : to_split)
      for (int octant = 0; octant < 8; ++octant) levels_[k].cells.push_back(child_of(cell, octant));
  }
  levels_[0].cells = cells_around(nodes[0]);
  for (std::size_t k = 0; k < levels_.size(); ++k) levels_[k].cell_table = LeafTable(levels_[k].cells);
}

void NestedElements::add_points(ElementLevel& level, const ElementLevel* coarser) {
  level.points = with_steps(level.cells, 1);
  const LeafTable table(level.points);
  level.corners.resize(level.cells.size());
  for (std::size_t c = 0; c < level.cells.size(); ++c)
    for (std::size_t corner = 0; corner < 8; ++corner)
      level.corners[c][corner] = table.find(moved(level.cells[c], corner_step(static_cast<int>(corner))));
  for (const LatticeCoordinates& node : level.nodes) level.point_of_node.push_back(table.find(node));
  const auto k = static_cast<std::size_t>(&level - levels_.data());
  level.first_part.assign(level.cells.size(), no_leaf);
  for (std::size_t c = 0; c < level.cells.size(); ++c) {
    if (k + 1 < levels_.size())
      level.first_part[c] = levels_[k + 1].cell_table.find(child_of(level.cells[c], 0));
    if (level.first_part[c] == no_leaf) level.finest.push_back(static_cast<int>(c));
  }
  level.weights.assign(level.finest.size(), 1.0);
  level.incident_begin.assign(level.points.size() + 1, 0);
  for (const int cell : level.finest)
    for (const int corner : level.corners[static_cast<std::size_t>(cell)])
      ++level.incident_begin[static_cast<std::size_t>(corner) + 1];
  std::partial_sum(level.incident_begin.begin(), level.incident_begin.end(), level.incident_begin.begin());
  level.incident.resize(8 * level.finest.size());
  std::vector<int> next = level.incident_begin;
  for (std::size_t number = 0; number < level.finest.size(); ++number)
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const int point = level.corners[static_cast<std::size_t>(level.finest[number])][corner];
      level.incident[static_cast<std::size_t>(next[static_cast<std::size_t>(point)]++)] = 8 * number + corner;
    }
  if (coarser == nullptr) return;
  const LeafTable coarse_table(coarser->points);
  level.parents_begin.push_back(0);
  for (const LatticeCoordinates& point : level.points) {
    const LatticeCoordinates below = parent_of(point), odd{point[0] & 1, point[1] & 1, point[2] & 1};
    for (int corner = 0; corner < 8; ++corner) {
      const LatticeCoordinates step = corner_step(corner);
      if (step[0] > odd[0] || step[1] > odd[1] || step[2] > odd[2]) continue;
      level.parents.push_back(coarse_table.find(moved(below, step)));
    }
    level.parents_begin.push_back(static_cast<int>(level.parents.size()));
  }
}

void NestedElements::weigh(std::vector<std::vector<double>> weights) {
  for (std::size_t k = 0; k < levels_.size(); ++k) levels_[k].weights = std::move(weights[k]);
}

std::vector<ElementPlace> NestedElements::places(const Vector3& x) const {
  std::vector<ElementPlace> result;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const ElementLevel& level = levels_[k];
    const Vector3 at = (x - origin_) / level.voxel_size;
    const LatticeCoordinates cell = lattice(k).cell_of(x);
    const int found = level.cell_table.find(cell);
    if (found == no_leaf) break;
    ElementPlace place{static_cast<int>(k), level.corners[static_cast<std::size_t>(found)], {}};
    const Vector3 within = at - as_vector(cell);
    for (int corner = 0; corner < 8; ++corner) {
      const LatticeCoordinates step = corner_step(corner);
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis) weight *= step[axis] ? within[axis] : 1 - within[axis];
      place.weights[static_cast<std::size_t>(corner)] = weight;
    }
    result.push_back(place);
  }
  return result;
}

std::vector<Points> NestedElements::values(const Points& coefficients) const {
  std::vector<Points> values;
  evaluate(coefficients, values);
  return values;
}

void NestedElements::evaluate(const Points& coefficients, std::vector<Points>& values) const {
  values.resize(levels_.size());
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const ElementLevel& level = levels_[k];
    Points& here = values[k];
    here.setZero(3, static_cast<Eigen::Index>(level.points.size()));
    if (k > 0)
      for (std::size_t p = 0; p < level.points.size(); ++p) {
        Vector3 sum = Vector3::Zero();
        const int begin = level.parents_begin[p], end = level.parents_begin[p + 1];
        for (int q = begin; q < end; ++q)
          sum += values[k - 1].col(level.parents[static_cast<std::size_t>(q)]);
        here.col(static_cast<Eigen::Index>(p)) = sum / (end - begin);
      }
    for (std::size_t n = 0; n < level.nodes.size(); ++n)
      here.col(level.point_of_node[n]) +=
          coefficients.col(static_cast<Eigen::Index>(level.first_unknown + n));
  }
}

Points NestedElements::restricted(std::vector<Points>& gradients) const {
  Points result(3, static_cast<Eigen::Index>(unknowns_));
  for (std::size_t k = levels_.size(); k-- > 0;) {
    const ElementLevel& level = levels_[k];
    for (std::size_t n = 0; n < level.nodes.size(); ++n)
      result.col(static_cast<Eigen::Index>(level.first_unknown + n)) =
          gradients[k].col(level.point_of_node[n]);
    if (k == 0) break;
    for (std::size_t p = 0; p < level.points.size(); ++p) {
      const int begin = level.parents_begin[p], end = level.parents_begin[p + 1];
      const Vector3 share = gradients[k].col(static_cast<Eigen::Index>(p)) / (end - begin);
      for (int q = begin; q < end; ++q)
        gradients[k - 1].col(level.parents[static_cast<std::size_t>(q)]) += share;
    }
  }
  return result;
}

Points transferred(const NestedElements& from, const Points& coefficients, const NestedElements& to) {
  Points result = Points::Zero(3, static_cast<Eigen::Index>(to.unknowns()));
  for (std::size_t k = 0; k < std::min(from.levels().size(), to.levels().size()); ++k) {
    const ElementLevel& before = from.levels()[k];
    const ElementLevel& after = to.levels()[k];
    std::size_t n = 0;
    for (std::size_t m = 0; m < before.nodes.size(); ++m) {  // both are sorted, and `after` holds all
      while (after.nodes[n] != before.nodes[m]) ++n;
      result.col(static_cast<Eigen::Index>(after.first_unknown + n)) =
          coefficients.col(static_cast<Eigen::Index>(before.first_unknown + m));
    }
  }
  return result;
}

Pyramid pyramid_of(const NestedElements& elements, const Points& coefficients, const Matrix3& linear) {
  Pyramid pyramid;
  pyramid.origin = elements.lattice(0).origin;
  std::vector<LeafCoordinates> finer;  // leaves of the level below
  for (std::size_t k = elements.levels().size(); k-- > 0;) {
    const ElementLevel& level = elements.levels()[k];
    std::vector<LeafCoordinates> leaves = parents_of(std::move(finer));
    for (const LatticeCoordinates& node : level.nodes) leaves.push_back(leaf_of(node));
    PyramidLevel stored;
    stored.voxel_size = level.voxel_size;
    stored.leaves = unique_leaves(std::move(leaves));
    stored.values.assign(leaf_floats * stored.leaves.size(), 0.F);
    const LeafTable table(stored.leaves);
    for (std::size_t n = 0; n < level.nodes.size(); ++n) {
      const Vector3 value = linear * coefficients.col(static_cast<Eigen::Index>(level.first_unknown + n));
      float* at = stored.values_of(static_cast<std::size_t>(table.find(leaf_of(level.nodes[n])))) +
                  3 * number_of_place(place_in_leaf(level.nodes[n]));
      for (int axis = 0; axis < 3; ++axis) at[axis] = static_cast<float>(value[axis]);
    }
    finer = stored.leaves;
    pyramid.levels.insert(pyramid.levels.begin(), std::move(stored));
  }
  return pyramid;
}

}  // namespace bespoke
