#include "bespoke/apply/chord_error.h"
#include "apply/motions.h"

#include <gtest/gtest.h>

namespace bespoke {
namespace {

using test::bend;

/// (x, y, z + x² / 2): the chord error of an edge that goes d along x is d² / 8.
/// A square from x = 0 to 1 and a triangle beside it, which reaches to x = 3.
Product square_and_triangle() {
  Product product;
  product.vertices.resize(3, 5);
  product.vertices << 0, 1, 1, 0, 3,  //
      0, 0, 1, 1, 0,                  //
      0, 0, 0, 0, 0;
  product.polygon_start = {0, 4, 7};
  product.corners = {0, 1, 2, 3, 2, 1, 4};
  return product;
}

TEST(ProductEdges, AreThereOnce) {
  const Eigen::Matrix2Xi edges = product_edges(square_and_triangle());
  Eigen::Matrix2Xi expected(2, 6);
  expected << 0, 0, 1, 1, 2, 2,  //
      1, 3, 2, 4, 3, 4;
  EXPECT_EQ(edges, expected);
}

TEST(ChordError, IsThatOfAParabola) {
  const ChordError error = worst_chord(square_and_triangle(), bend);
  EXPECT_EQ(error.edges, 6u);
  EXPECT_DOUBLE_EQ(error.length, 0.5);  // 2² / 8
  EXPECT_EQ(error.place[0], 2);
}

TEST(ChordError, IsZeroWhereNothingBends) {
  const ChordError error =
      worst_chord(square_and_triangle(), [](const Points& x) -> Points { return 2 * x; });
  EXPECT_EQ(error.length, 0);
}

TEST(ChordError, OfPointsIsZero) {
  Product points = square_and_triangle();
  points.polygon_start = {0};
  points.corners.clear();
  EXPECT_EQ(worst_chord(points, bend).edges, 0u);
  EXPECT_EQ(worst_chord(Product(), bend).length, 0);
}

}  // namespace
}  // namespace bespoke
