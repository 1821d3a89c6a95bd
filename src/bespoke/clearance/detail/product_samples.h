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

/// Every vertex; and the middles of edges, lines (2×l) and faces with an edge longer than `spacing` (mesh
/// units, > 0).
ProductSamples constraint_samples(const TriangleMesh& product, const Eigen::Matrix2Xi& lines, double spacing);

/// The middle of every edge and line, and 16 places a face, the middles of its sixteenths; more, up to 256,
/// of a face with an edge longer than 8 spacings.
ProductSamples check_samples(const TriangleMesh& product, const Eigen::Matrix2Xi& lines, double spacing);

/// Of the product's faces the places nearest to points (3×k, in the product's frame), where one is within
/// `reach` (mesh units).
ProductSamples nearest_samples(const TriangleMesh& product, const Points& points, double reach);

/// Where they are (3×k), or some of them, on the vertices (3×n) at hand.
Points places_of(const ProductSamples& samples, const Points& vertices);
Points places_of(const ProductSamples& samples, const std::vector<int>& columns, const Points& vertices);

/// Some of them, or all, after others.
void append(const ProductSamples& from, const std::vector<int>& columns, ProductSamples& to);
void append(const ProductSamples& from, ProductSamples& to);

}  // namespace bespoke
