#pragma once

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/product/product_io.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke::test {

/// E = id.
class IdentityMap : public ElasticMap {
 public:
  AffineMap affine() const override { return {}; }
  Points displacement(const Points& x) const override { return Points::Zero(3, x.cols()); }
  Points displacement_gradient(const Points& x) const override { return Points::Zero(3, 3 * x.cols()); }
  Support support() const override { return {}; }
};

/// A quadrangle and a triangle beside it, with texture coordinates that differ at one of their common
/// vertices, and a vertex that no face has.
inline Product two_polygons() {
  Product product;
  product.vertices.resize(3, 6);
  product.vertices << 0, 1, 1, 0, 2, 9,  //
      0, 0, 1, 1, 0.5, 9,                //
      0, 0, 0, 0, 0, 9;
  product.polygon_start = {0, 4, 7};
  product.corners = {0, 1, 2, 3, 1, 4, 2};
  product.texture.resize(2, 7);
  product.texture << 0, 0.5, 0.5, 0, 0.5, 1, 0.75,  //
      0, 0, 1, 1, 0, 0.25, 1;
  product.has_normals = true;
  return product;
}

/// Half a turn about the y axis, and a shift.
inline RigidTransform half_turn() { return {Vector3(-1, 1, -1).asDiagonal(), Vector3(4, 5, 6)}; }

}  // namespace bespoke::test
