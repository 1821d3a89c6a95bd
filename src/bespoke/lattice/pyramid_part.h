#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/lattice/pyramid.h"

namespace bespoke {

/// The leaves from `low` to `high` along each axis, both among them.
struct LeafBox {
  LeafCoordinates low{};
  LeafCoordinates high{};
};

/// A pyramid of which every leaf is known, and the values of some: what a product requires.
struct PyramidPart {
  Pyramid read;  ///< the leaves whose values are here; maybe none of a level
  std::vector<std::vector<LeafCoordinates>> leaves;  ///< of every level, all, in lexicographic order

  std::size_t leaf_count() const;  ///< all leaves of all levels
};

/// Throws InvalidInput, naming the level, unless all holds of the whole that require_valid(Pyramid) requires,
/// as far as it is known, and every leaf with values is one of the whole's.
void require_valid(const PyramidPart& part);

/// The leaves whose values look-ups of points in the box (mesh units, not empty) touch on one level: those of
/// the points' entries (PyramidEntry) and their upper neighbours, with a cell to spare for rounding.
LeafBox leaves_near(const Lattice& lattice, const Box& box);

/// A box that holds E(x) = affine x + u(x) of all points x of `box`, whose leaves have been read (mesh
/// units): the affine part's image of the box, widened by the least and the largest values of every level.
Box image_box(const Box& box, const AffineMap& affine, const PyramidPart& part);

}  // namespace bespoke
