#include "bespoke/surface_fit/graph/block_system.h"

#include <algorithm>
#include <cassert>
#include <string>

#include "bespoke/error.h"

namespace bespoke {

BlockSystem::BlockSystem(std::vector<std::vector<int>> adjacency) {
  const int count = static_cast<int>(adjacency.size());
  start_.push_back(0);
  for (int column = 0; column < count; ++column) {
    std::vector<int>& rows = adjacency[column];
    rows.push_back(column);
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    rows_.insert(rows_.end(), std::lower_bound(rows.begin(), rows.end(), column), rows.end());
    start_.push_back(static_cast<int>(rows_.size()));
  }
  set_zero();

  matrix_.resize(3 * count, 3 * count);
  Eigen::VectorXi entries(3 * count);
  for (int column = 0; column < count; ++column)
    for (int b = 0; b < 3; ++b) entries[3 * column + b] = 3 * (start_[column + 1] - start_[column]) - b;
  matrix_.reserve(entries);
  for (int column = 0; column < count; ++column)
    for (int b = 0; b < 3; ++b)
      for (int k = start_[column]; k < start_[column + 1]; ++k)
        for (int a = rows_[k] == column ? b : 0; a < 3; ++a)
          matrix_.insert(3 * rows_[k] + a, 3 * column + b) = 1;
  matrix_.makeCompressed();
  factor_.analyzePattern(matrix_);
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
  double* value = matrix_.valuePtr();
  for (int column = 0; column < size(); ++column)
    for (int b = 0; b < 3; ++b)
      for (int k = start_[column]; k < start_[column + 1]; ++k)
        for (int a = rows_[k] == column ? b : 0; a < 3; ++a) *value++ = blocks_[k](a, b);
  factor_.factorize(matrix_);
  if (factor_.info() != Eigen::Success)
    throw SolverError("the system of " + std::to_string(size()) +
                      " deformation nodes is not positive definite; check the meshes for huge coordinates");
  const Eigen::VectorXd solution = factor_.solve(right_side_);
  return Eigen::Map<const Points>(solution.data(), 3, size());
}

}  // namespace bespoke
