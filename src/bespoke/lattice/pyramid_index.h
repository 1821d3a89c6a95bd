#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bespoke/lattice/leaf_table.h"
#include "bespoke/lattice/pyramid.h"
#include "bespoke/lattice/pyramid_part.h"

namespace bespoke {

/// The 8³ cells whose lower nodes are the nodes of one leaf position; the leaf itself may be absent when a
/// neighbour on its upper side exists, because cells that straddle the two are not zero.
struct PyramidEntry {
  LeafCoordinates leaf{};
  /// Values of the leaves at `leaf` + corner_step(0 … 7); zeros where there is none.
  std::array<const float*, 8> blocks{};
  /// Entries of the next level that cover the octants, or no_leaf.
  std::array<std::int32_t, 8> children{};
};

/// The values that stand for a leaf that is not there: zeros.
const float* absent_leaf();

/// The values that stand for a leaf whose own were not read: NaN.
const float* unread_leaf();

/// Neighbours and children of the leaves of a pyramid, found once. Refers to the pyramid's values: the
/// pyramid must live longer and stay as it is. Every entry but those of level 0 is the child of one entry.
struct PyramidIndex {
  explicit PyramidIndex(const Pyramid& pyramid);
  /// The same entries as of the whole.
  explicit PyramidIndex(const PyramidPart& part);

  std::vector<std::vector<PyramidEntry>> levels;  ///< entries in lexicographic order
  LeafTable roots;                                ///< finds the entries of level 0

 private:
  void add_level(std::size_t level, const PyramidLevel& read, const std::vector<LeafCoordinates>& all);
};

/// Sum of the levels at the columns of x (3×n, mesh units), 3×n; NaN where x is not finite.
Points look_up(const Pyramid& pyramid, const PyramidIndex& index, const Points& x);

/// Its gradient: 3×3n as ElasticMap::displacement_gradient; on a face shared by two cells, of the upper one.
Points look_up_gradient(const Pyramid& pyramid, const PyramidIndex& index, const Points& x);

}  // namespace bespoke
