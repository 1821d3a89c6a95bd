#include "bespoke/surface_fit/detail/correspondence.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(CompatiblePoints, FindsTheFootOfThePerpendicular) {
  const CompatiblePoints target(shapes::square_grid(4));
  Points vertices(3, 2), normals(3, 2);
  vertices << 0.3, 0.7, 0.6, 0.2, 0.5, -0.25;
  normals.colwise() = Vector3::UnitZ();
  const Correspondence found = target.closest(vertices, normals);
  EXPECT_EQ(found.unmatched, 0u);
  EXPECT_TRUE(found.points.col(0).isApprox(Vector3(0.3, 0.6, 0), 1e-14));
  EXPECT_TRUE(found.points.col(1).isApprox(Vector3(0.7, 0.2, 0), 1e-14));
}

TEST(CompatiblePoints, PassesOverSurfacesThatFaceAway) {
  TriangleMesh sheet = shapes::square_grid(4);
  TriangleMesh far_sheet = sheet;
  far_sheet.vertices.row(2).setConstant(-1);
  sheet.faces.row(0).swap(sheet.faces.row(1));  // the near one faces down
  const CompatiblePoints target(shapes::joined(sheet, far_sheet));
  const Correspondence found = target.closest(Vector3(0.3, 0.6, 0.1), Vector3::UnitZ());
  ASSERT_EQ(found.unmatched, 0u);
  EXPECT_TRUE(found.points.col(0).isApprox(Vector3(0.3, 0.6, -1), 1e-14));
}

TEST(CompatiblePoints, CountsWhatFindsNothing) {
  const CompatiblePoints target(shapes::square_grid(4));
  Points vertices(3, 4), normals(3, 4);
  vertices.colwise() = Vector3(0.5, 0.5, 1);
  vertices.col(3) = Vector3(1.5, 0.5, 0);  // beyond the boundary
  normals << 0, 1, 0, 0,                   //
      0, 0, 0, 0,                          //
      0, 0, -1, 1;
  const Correspondence found = target.closest(vertices, normals);
  EXPECT_EQ(found.unmatched, 4u);
  EXPECT_EQ(found.points, vertices);
  EXPECT_THROW(target.closest(vertices, normals.leftCols(2)), InvalidInput);
}

TEST(CompatiblePoints, AnswersAtInnerEdgesAndVertices) {
  const CompatiblePoints target(shapes::square_grid(2));
  Points vertices(3, 2);
  vertices.col(0) = Vector3(0.5, 0.5, 0.1);
  vertices.col(1) = Vector3(0.5, 0.25, 0.1);
  const Correspondence found = target.closest(vertices, Vector3::UnitZ().replicate(1, 2));
  EXPECT_EQ(found.unmatched, 0u);
}

}  // namespace
}  // namespace bespoke
