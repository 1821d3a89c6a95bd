#pragma once

#include "bespoke/apply/chord_error.h"
#include "bespoke/product/face_splits.h"

namespace bespoke {

struct RefinedProduct {
  Product product;    ///< the vertices of the input first, in their order
  FaceSplits splits;  ///< what became of the input's faces
  ChordError chord;   ///< of the refined product
};

/// Splits every edge whose chord error exceeds `length` (> 0, mesh units) at its middle, in rounds. Triangles
/// become two, three or four; other polygons and lines get further corners; texture coordinates are
/// interpolated. Edges at the same places are split alike, so no gaps open; edges of rigid parts are
/// straight. Throws InvalidInput for other lengths and where more than `max_vertices` or twenty rounds would
/// be needed.
RefinedProduct refine_product(Product product, const ImageOfPoints& image, double length,
                              VertexParts parts = {}, std::size_t max_vertices = std::size_t{1} << 26);

}  // namespace bespoke
