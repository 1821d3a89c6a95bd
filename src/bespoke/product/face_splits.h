#pragma once

#include <utility>
#include <vector>

namespace bespoke {

/// What splitting edges at their middles makes of a product's polygons, told by what every middle lies
/// between, so that whatever a file says of vertices and corners can be put there as well. The product has n
/// vertices and c corners.
struct FaceSplits {
  /// A corner at the middle of an edge; its number is c plus its place in `corners`.
  struct Corner {
    int before = 0, behind = 0;  ///< numbers of the corners of the edge, smaller than its own
    int vertex = 0;
  };

  /// The ends of the edge whose middle is vertex n + i, of polygons and of lines.
  std::vector<std::pair<int, int>> vertices;
  std::vector<Corner> corners;
  /// Polygon k has become the parts first_part[k] … first_part[k+1]-1, which together have all of its corners
  /// and all that lie between them.
  std::vector<int> first_part;
  std::vector<int> part_start;    ///< part i is part_corners[start[i]] … part_corners[start[i+1]-1]
  std::vector<int> part_corners;  ///< numbers of corners
};

}  // namespace bespoke
