#include "bespoke/clearance/corrected_map.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/mapping/reach.h"
#include "clearance/balls.h"

namespace bespoke {
namespace {

std::shared_ptr<const ElasticMap> identity_map() {
  return std::make_shared<BakedMap>(AffineMap{}, Pyramid{});
}

RigidTransform quarter_turn() {
  RigidTransform turn;
  turn.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  turn.translation = Vector3(5, 6, 7);
  return turn;
}

std::shared_ptr<const PreparedProduct> prepared(const TriangleMesh& product) {
  return std::make_shared<const PreparedProduct>(product);
}

TEST(CorrectedMap, TakesTheProductToWhereItWasCorrected) {
  const TriangleMesh product = test::shell(1, 2);
  const RigidTransform turn = quarter_turn();
  const Points carried = turn * product.vertices;
  Points corrected = carried;
  corrected.col(7) += Vector3(0.1, 0.2, 0.3);
  const auto map = corrected_map(identity_map(), turn, prepared(product), carried, corrected);
  EXPECT_LT((turn * (*map)(product.vertices) - corrected).norm(), 1e-12);
  // To the bit where nothing was corrected.
  EXPECT_EQ((*map)(product.vertices).col(3), product.vertices.col(3));
  // Between its vertices as its faces are.
  const Eigen::Vector3i face = product.faces.col(5);
  const Points middle = (product.vertices.col(face[0]) + product.vertices.col(face[1])) / 2;
  const Points image = (corrected.col(face[0]) + corrected.col(face[1])) / 2;
  EXPECT_LT((turn * (*map)(middle)-image).norm(), 1e-12);
}

TEST(CorrectedMap, NormalsTurnWithTheFaces) {
  // A flat sheet that is lifted along x: z becomes 0.3 x.
  TriangleMesh sheet = shapes::square_grid(6);
  Points corrected = sheet.vertices;
  for (auto vertex : corrected.colwise()) vertex.z() += 0.3 * vertex.x();
  const auto map =
      corrected_map(identity_map(), RigidTransform{}, prepared(sheet), sheet.vertices, corrected);
  for (Eigen::Index v = 0; v < sheet.vertices.cols(); ++v) {
    const Matrix3 gradient = map->displacement_gradient(sheet.vertices.col(v));
    EXPECT_NEAR(gradient(2, 0), 0.3, 1e-4) << v;
    EXPECT_NEAR(gradient.norm(), 0.3, 1e-4) << v;
  }
}

TEST(CorrectedMap, WhatACorrectionMovesIsNotWithinReachForThat) {
  const TriangleMesh product = test::shell(1, 1);
  const Points corrected = product.vertices.colwise() + Vector3(0, 0, 0.1);
  const auto map = corrected_map(identity_map(), {}, prepared(product), product.vertices, corrected);
  EXPECT_EQ(count_in_reach(*map, product.vertices, map->displacement(product.vertices)), 0u);
}

TEST(CorrectedMap, RefusesSizesThatDiffer) {
  const TriangleMesh product = test::shell(1, 1);
  EXPECT_THROW(corrected_map(identity_map(), {}, prepared(product), product.vertices, Points(3, 1)),
               InvalidInput);
}

}  // namespace
}  // namespace bespoke
