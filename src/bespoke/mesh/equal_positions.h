#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// Columns of a point matrix, grouped by exactly equal position (0 and −0 are equal).
struct EqualPositions {
  /// Sorted by position (x, then y, then z); columns at one position in the order they were given in.
  std::vector<int> columns;
  std::vector<std::size_t>
      start;  ///< group g is columns[start[g]] … columns[start[g + 1] - 1]; one more entry

  std::size_t groups() const { return start.size() - 1; }
  std::span<const int> group(std::size_t index) const {
    return {columns.data() + start[index], start[index + 1] - start[index]};
  }
};

/// points: 3×n, mesh units. Throws InvalidInput when a column requested is not finite.
EqualPositions equal_positions(const Points& points);

/// Of the given columns alone, each at most once.
EqualPositions equal_positions(const Points& points, std::vector<int> columns);

/// For every column of points, 3×n, the first one at its position. Throws as equal_positions.
std::vector<int> first_at_equal_position(const Points& points);

}  // namespace bespoke
