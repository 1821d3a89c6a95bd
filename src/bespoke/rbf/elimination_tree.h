#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/rbf/point_grid.h"
#include "bespoke/types.h"

namespace bespoke {

/// For every point the points within a radius, itself included: those of point i are
/// `neighbours[start[i]] … neighbours[start[i + 1] - 1]`, with their distances.
struct RadiusGraph {
  std::vector<std::size_t> start;  ///< n+1
  std::vector<int> neighbours;
  std::vector<double> distances;  ///< mesh units

  /// Index, distance and the value of a matrix entry.
  static constexpr std::size_t bytes_per_entry = sizeof(int) + 2 * sizeof(double);
};

/// points: 3×n, finite; radius > 0, mesh units. Throws InvalidInput.
RadiusGraph radius_graph(const Points& points, double radius);

/// Nested dissection of a radius graph by planes across the longest side of what is left: separators are as
/// wide as the radius, so the factor consists of few, large, dense fronts.
class EliminationTree {
 public:
  /// A dense front: `own` points are eliminated, `boundary` are the later points they couple with.
  struct Front {
    std::vector<int> own;
    std::vector<int> boundary;  ///< in the order of elimination
    int children[2] = {-1, -1};
  };

  EliminationTree(const Points& points, const RadiusGraph& graph, double radius);

  const std::vector<Front>& fronts() const {
    return fronts_;
  }  ///< children before parents; the last is the root

  /// Place of a point in the order of elimination; a front's own points are consecutive.
  int position(int point) const { return positions_[static_cast<std::size_t>(point)]; }

  std::size_t factor_entries() const;

  /// Of factor and temporary fronts at the worst moment of a factorisation.
  std::size_t peak_bytes() const;

 private:
  std::vector<Front> fronts_;
  std::vector<int> positions_;
};

}  // namespace bespoke
