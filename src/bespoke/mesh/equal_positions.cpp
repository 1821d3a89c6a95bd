#include "bespoke/mesh/equal_positions.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {

EqualPositions equal_positions(const Points& points) {
  std::vector<int> all(static_cast<std::size_t>(points.cols()));
  std::iota(all.begin(), all.end(), 0);
  return equal_positions(points, std::move(all));
}

EqualPositions equal_positions(const Points& points, std::vector<int> columns) {
  // Not-a-number is not ordered, so that sorting it would be undefined.
  for (const int column : columns)
    if (!points.col(column).allFinite())
      throw InvalidInput("point " + std::to_string(column) + " has a coordinate that is not finite");
  const auto before = [&](int i, int j) {
    const auto a = points.col(i), b = points.col(j);
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::stable_sort(columns.begin(), columns.end(), before);
  EqualPositions equal{std::move(columns), {}};
  for (std::size_t k = 0; k < equal.columns.size(); ++k)
    if (k == 0 || before(equal.columns[k - 1], equal.columns[k])) equal.start.push_back(k);
  equal.start.push_back(equal.columns.size());
  return equal;
}

std::vector<int> first_at_equal_position(const Points& points) {
  const EqualPositions equal = equal_positions(points);
  std::vector<int> first(static_cast<std::size_t>(points.cols()));
  for (std::size_t group = 0; group < equal.groups(); ++group)
    for (const int column : equal.group(group))
      first[static_cast<std::size_t>(column)] = equal.group(group).front();
  return first;
}

}  // namespace bespoke
