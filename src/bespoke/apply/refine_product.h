#pragma once

#include "bespoke/apply/chord_error.h"
#include "bespoke/product/face_splits.h"

namespace bespoke {

struct RefinedProduct {
  Product product;    ///< the vertices of the input first, in their order
  FaceSplits splits;  ///< what became of the input's faces
  ChordError chord;   ///< of the refined product
};

/// Splits, in rounds, every edge whose chord error exceeds `length` (> 0, mesh units) at its middle, until
/// none does. Triangles become two, three or four; a polygon of more corners gets the middles as further
/// corners, and so do lines. Texture coordinates are interpolated. What polygons share stays shared, and
/// edges at the same places are split alike, so that no gaps open. Throws InvalidInput unless the length is
/// positive, and for one that would take more than `max_vertices`, or that does not suffice after twenty
/// rounds.
///
/// Edges of parts that keep their shape are straight; a neighbour's longest edge is split all the same.
RefinedProduct refine_product(Product product, const ImageOfPoints& image, double length,
                              VertexParts parts = {}, std::size_t max_vertices = std::size_t{1} << 26);

}  // namespace bespoke
