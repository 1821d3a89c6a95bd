#pragma once

#include <optional>
#include <vector>

#include "bespoke/lattice/baked_map.h"
#include "bespoke/lattice/finest_cells.h"

namespace bespoke {

/// Finds preimages by looking into every finest cell whose image may hold the point: slow, but without a
/// starting value that could be wrong. `map` must outlive the search. Thread-safe.
class CellSearch {
 public:
  explicit CellSearch(const BakedMap& map);

  /// x with |E(x) − y| ≤ tolerance (mesh units) in one of the cells, nothing when no cell has such a point.
  std::optional<Vector3> find(const Vector3& y, double tolerance) const;

 private:
  struct Entry {
    int level;
    LeafCoordinates leaf;
    CellMask finest;
    Box image;  // of all nodes
  };
  std::optional<Vector3> find_in(const Entry& entry, const Vector3& y, double tolerance) const;

  const BakedMap& map_;
  std::vector<Entry> entries_;
};

}  // namespace bespoke
