#include "bespoke/surface_fit/graph/block_system.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <string>

#include "bespoke/error.h"

namespace bespoke {
namespace {

/// Of the unknowns' coordinates; sorts the adjacency, and makes its entries and the diagonal unique.
RadiusGraph scalar_graph(std::vector<std::vector<int>>& adjacency) {
  RadiusGraph graph;
  graph.start.push_back(0);
  for (std::size_t i = 0; i < adjacency.size(); ++i) {
    std::vector<int>& row = adjacency[i];
    row.push_back(static_cast<int>(i));
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    for (int coordinate = 0; coordinate < 3; ++coordinate) {
      for (const int other : row)
        for (int b = 0; b < 3; ++b) graph.neighbours.push_back(3 * other + b);
      graph.start.push_back(graph.neighbours.size());
    }
  }
  return graph;
}

/// Each place three times.
Points of_coordinates(const Points& places) {
  Points all(3, 3 * places.cols());
  for (Eigen::Index i = 0; i < all.cols(); ++i) all.col(i) = places.col(i / 3);
  return all;
}

}  // namespace

BlockSystem::BlockSystem(std::vector<std::vector<int>> adjacency, const Points& places)
    : graph_(scalar_graph(adjacency)),
      tree_(of_coordinates(places), graph_, std::numeric_limits<double>::infinity()),
      values_(graph_.neighbours.size(), 0) {
  const int count = static_cast<int>(adjacency.size());
  const auto entry = [&](int column, int row) {
    const std::vector<int>& rows = adjacency[column];
    const auto slot = std::lower_bound(rows.begin(), rows.end(), row) - rows.begin();
    return graph_.start[3 * column] + 3 * static_cast<std::size_t>(slot);
  };
  start_.push_back(0);
  for (int column = 0; column < count; ++column) {
    const std::vector<int>& rows = adjacency[column];
    for (auto row = std::lower_bound(rows.begin(), rows.end(), column); row != rows.end(); ++row) {
      rows_.push_back(*row);
      entries_.push_back({entry(column, *row), entry(*row, column)});
    }
    start_.push_back(static_cast<int>(rows_.size()));
  }
  set_zero();
}

void BlockSystem::set_zero() {
  blocks_.assign(rows_.size(), Matrix3::Zero());
  right_side_ = Eigen::VectorXd::Zero(3 * size());
}

Matrix3& BlockSystem::at(int row, int column) {
  // Halving without branches: the processor guesses every other one of a binary search wrongly.
  std::size_t first = start_[column];
  for (std::size_t count = start_[column + 1] - first; count > 1;) {
    const std::size_t half = count / 2;
    first += rows_[first + half] <= row ? half : 0;
    count -= half;
  }
  assert(rows_[first] == row);
  return blocks_[first];
}

Points BlockSystem::gradient(const Points& x) const {
  Points sum = -Eigen::Map<const Points>(right_side_.data(), 3, size());
  for (int column = 0; column < size(); ++column)
    for (int k = start_[column]; k < start_[column + 1]; ++k) {
      sum.col(rows_[k]) += blocks_[k] * x.col(column);
      if (rows_[k] != column) sum.col(column) += blocks_[k].transpose() * x.col(rows_[k]);
    }
  return 2 * sum;
}

Points BlockSystem::solve() {
  for (int column = 0; column < size(); ++column)
    for (int k = start_[column]; k < start_[column + 1]; ++k) {
      const std::size_t below = 3 * width(column), beside = 3 * width(rows_[k]);
      for (int b = 0; b < 3; ++b)
        for (int a = 0; a < 3; ++a) {
          values_[entries_[k].column + b * below + a] = blocks_[k](a, b);
          values_[entries_[k].row + a * beside + b] = blocks_[k](a, b);
        }
    }
  try {
    factor_.emplace(tree_, graph_, values_);
  } catch (const SolverError&) {
    throw SolverError("the system of " + std::to_string(size()) +
                      " deformation nodes is not positive definite; check the meshes for huge coordinates");
  }
  const Eigen::VectorXd solution = factor_->solve(right_side_);
  return Eigen::Map<const Points>(solution.data(), 3, size());
}

Matrix3 BlockSystem::compliance(const std::vector<NodeWeight>& combination) const {
  Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(3 * size(), 3);
  for (const NodeWeight& entry : combination)
    forces.middleRows<3>(3 * entry.node) += entry.weight * Matrix3::Identity();
  return forces.transpose() * factor_->solve(forces);
}

}  // namespace bespoke
