#include "bespoke/page/detail/display_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "bespoke/error.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(DisplayMesh, ShowsAllOfASmallMesh) {
  const TriangleMesh sphere = shapes::icosphere(2);
  const DisplayMesh display = display_mesh(sphere, 320);
  EXPECT_TRUE(display.is_whole);
  EXPECT_EQ(display.faces, sphere.faces);
  EXPECT_EQ(display.shown(sphere.vertices), sphere.vertices);
}

TEST(DisplayMesh, ThinsALargeMeshToVerticesOfItsOwn) {
  const TriangleMesh sphere = shapes::icosphere(5);
  const std::size_t most = 2000;
  const DisplayMesh display = display_mesh(sphere, most);
  EXPECT_FALSE(display.is_whole);
  EXPECT_LE(display.faces.cols(), static_cast<Eigen::Index>(most));
  EXPECT_GT(display.faces.cols(), static_cast<Eigen::Index>(most - 3));
  EXPECT_TRUE(std::is_sorted(display.original.begin(), display.original.end()));
  const TriangleMesh shown{display.shown(sphere.vertices), display.faces};
  EXPECT_LT((shown.vertices.colwise().norm().array() - 1).abs().maxCoeff(), 1e-12);
  // Still a closed surface, outward, of about the volume of the ball: a polyhedron of edges as long as e is
  // lower by e² / 8.
  double volume = 0;
  for (Eigen::Index f = 0; f < shown.faces.cols(); ++f)
    volume += shown.vertices.col(shown.faces(0, f))
                  .dot(shown.vertices.col(shown.faces(1, f)).cross(shown.vertices.col(shown.faces(2, f)))) /
              6;
  constexpr double ball = 4.0 / 3 * 3.14159265358979;
  EXPECT_LT(volume, ball);
  EXPECT_GT(volume, 0.98 * ball);
}

TEST(DisplayMesh, ThinsPointsWithoutFaces) {
  const TriangleMesh points{shapes::icosphere(4).vertices, Faces(3, 0)};
  const DisplayMesh display = display_mesh(points, 500);
  EXPECT_LE(display.original.size(), 500u);
  EXPECT_GT(display.original.size(), 100u);
  EXPECT_EQ(display.faces.cols(), 0);
}

TEST(DisplayMesh, ThinsTrianglesThatShareNoVertices) {
  TriangleMesh scattered = shapes::soup(shapes::icosphere(4));
  // Each about its first corner half as large, so that none meets another.
  for (Eigen::Index f = 0; f < scattered.faces.cols(); ++f)
    for (int k = 1; k < 3; ++k)
      scattered.vertices.col(3 * f + k) =
          0.5 * (scattered.vertices.col(3 * f + k) + scattered.vertices.col(3 * f)).eval();
  const DisplayMesh display = display_mesh(scattered, 1000);
  EXPECT_FALSE(display.is_whole);
  EXPECT_LE(display.faces.cols(), 1000);
  EXPECT_GT(display.faces.cols(), 100);
}

TEST(DisplayMesh, RefusesFacesWithoutVertices) {
  TriangleMesh mesh = shapes::triangle();
  mesh.faces(1, 0) = 3;
  EXPECT_THROW(display_mesh(mesh, 10), InvalidInput);
}

}  // namespace
}  // namespace bespoke
