#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Places of a product: means of three vertices, which may be the same.
struct ProductSamples {
  Faces vertices;  ///< 3×k
  Points weights;  ///< 3×k, columns sum to 1

  Eigen::Index count() const { return vertices.cols(); }
};

/// Every vertex, the middle of every edge and of every line (2×l), and of every face the middle and, where an
/// edge is longer than `spacing` (mesh units), a lattice as fine as that, up to `most_divisions` an edge.
ProductSamples constraint_samples(const TriangleMesh& product, const Eigen::Matrix2Xi& lines, double spacing);

/// 16 places a face, the middles of its sixteenths.
ProductSamples check_samples(const TriangleMesh& product);

/// Where they are (3×k), on the vertices (3×n) at hand.
Points places_of(const ProductSamples& samples, const Points& vertices);

/// Some of them after others.
void append(const ProductSamples& from, const std::vector<int>& columns, ProductSamples& to);

}  // namespace bespoke
