#include "bespoke/mesh/spread_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(SpreadPoints, TakesTheFarthestFromThoseBeforeAndOneOfAPlace) {
  Points points(3, 6);
  points << 0, 1, 9, 9, 4, 10,  //
      0, 0, 0, 0, 0, 0,         //
      0, 0, 0, 0, 0, 0;
  EXPECT_THAT(spread_points(points, 9), testing::ElementsAre(0, 5, 4, 1, 2));
  EXPECT_THAT(spread_points(points, 2), testing::ElementsAre(0, 5));
  EXPECT_THAT(spread_points(Points(3, 0), 2), testing::IsEmpty());
}

TEST(SpreadVertices, AreFarFromOneAnotherAndInFaces) {
  TriangleMesh mesh = shapes::icosphere(3);
  mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
  mesh.vertices.rightCols<1>() = Vector3(9, 9, 9);  // in no face
  const std::vector<int> chosen = spread_vertices(mesh, 12);
  ASSERT_EQ(chosen.size(), 12u);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    EXPECT_LT(chosen[i], mesh.vertices.cols() - 1);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GT((mesh.vertices.col(chosen[i]) - mesh.vertices.col(chosen[j])).norm(), 0.7);
    }
  }
  EXPECT_EQ(spread_vertices(mesh, 100'000).size(), static_cast<std::size_t>(mesh.vertices.cols() - 1));
}

}  // namespace
}  // namespace bespoke
