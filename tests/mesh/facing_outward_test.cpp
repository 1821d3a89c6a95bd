#include "bespoke/mesh/facing_outward.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/bent_tube.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TriangleMesh inside_out(TriangleMesh mesh) {
  mesh.faces.row(1).swap(mesh.faces.row(2));
  return mesh;
}

TriangleMesh mirrored(TriangleMesh mesh) {
  mesh.vertices.row(0) *= -1;
  return mesh;
}

/// What lies on one side of a plane through the middle, open there.
TriangleMesh half(const TriangleMesh& mesh) {
  TriangleMesh result{mesh.vertices, Faces(3, mesh.faces.cols())};
  Eigen::Index count = 0;
  for (const auto& face : mesh.faces.colwise())
    if ((mesh.vertices(0, Eigen::all)(face).array() > 0).all()) result.faces.col(count++) = face;
  result.faces.conservativeResize(3, count);
  return result;
}

TEST(SignedVolume, IsThatOfABallWhereverItLies) {
  TriangleMesh ball = shapes::icosphere(5);
  const double volume = 4.0 / 3 * std::numbers::pi;
  EXPECT_NEAR(signed_volume(ball), volume, 0.005 * volume);
  EXPECT_NEAR(signed_volume(inside_out(ball)), -signed_volume(ball), 1e-12);
  ball.vertices.colwise() += Vector3(100, -20, 3);
  EXPECT_NEAR(signed_volume(ball), volume, 0.005 * volume);
}

TEST(FacesOutward, OfClosedAndOpenSurfacesAndTheirMirrorImages) {
  for (TriangleMesh mesh : {shapes::icosphere(3), half(shapes::icosphere(3)), shapes::tube()}) {
    mesh.vertices.colwise() += Vector3(5, 6, 7);
    ASSERT_TRUE(faces_outward(mesh).has_value());
    EXPECT_TRUE(*faces_outward(mesh));
    EXPECT_FALSE(*faces_outward(inside_out(mesh)));
    EXPECT_FALSE(*faces_outward(mirrored(mesh)));
    EXPECT_TRUE(*faces_outward(mirrored(inside_out(mesh))));
  }
}

TEST(FacesOutward, IsNotAskedOfASheet) {
  EXPECT_FALSE(faces_outward(shapes::square_grid(9)).has_value());
  EXPECT_FALSE(faces_outward({Points(3, 0), Faces(3, 0)}).has_value());
}

}  // namespace
}  // namespace bespoke
