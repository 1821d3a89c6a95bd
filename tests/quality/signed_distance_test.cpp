#include "bespoke/quality/signed_distance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bespoke/error.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

// Of the cube [0, 1]³.
double distance_from_cube(const Vector3& x) {
  const Eigen::Array3d outside = (x.array() - 0.5).abs() - 0.5;
  return outside.maxCoeff() > 0 ? outside.max(0).matrix().norm() : outside.maxCoeff();
}

/// Every face with vertices of its own, as STL has them.
TriangleMesh unshared(const TriangleMesh& mesh) {
  TriangleMesh result;
  result.vertices.resize(3, 3 * mesh.faces.cols());
  result.faces.resize(3, mesh.faces.cols());
  for (int i = 0; i < 3 * mesh.faces.cols(); ++i) {
    result.vertices.col(i) = mesh.vertices.col(mesh.faces.reshaped()(i));
    result.faces.reshaped()(i) = i;
  }
  return result;
}

TEST(SignedDistance, OfACubeIsKnown) {
  const Points x = (1.5 * test::random_points(3000, 1)).array() + 0.5;
  for (const TriangleMesh& cube : {shapes::cube(), unshared(shapes::cube())}) {
    const SignedDistance::Values values = SignedDistance(cube)(x);
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      EXPECT_NEAR(values.distance[static_cast<std::size_t>(i)], distance_from_cube(x.col(i)), 1e-15);
      EXPECT_TRUE(values.sided[static_cast<std::size_t>(i)]);
    }
  }
}

TEST(SignedDistance, IsRightAtEdgesWhereFaceNormalsDisagree) {
  // A thin wedge: beyond its sharp edge one face alone would call most points inside.
  TriangleMesh wedge;
  wedge.vertices = Points{{0, 0, 1, 1, 1, 1}, {-1, 1, -1, 1, -1, 1}, {0, 0, 0.05, 0.05, -0.05, -0.05}};
  wedge.faces = Faces{{0, 0, 0, 0, 2, 2, 0, 1}, {2, 3, 1, 5, 4, 5, 4, 3}, {3, 1, 5, 4, 5, 3, 2, 5}};
  const Points x = test::random_points(2000, 2).array().colwise() * Eigen::Array3d(0.5, 0.9, 0.5);
  const SignedDistance::Values values = SignedDistance(wedge)(x);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const bool inside = x(0, i) > 0 && std::abs(x(2, i)) < 0.05 * x(0, i);
    EXPECT_EQ(values.distance[static_cast<std::size_t>(i)] < 0, inside) << x.col(i).transpose();
  }
}

TEST(SignedDistance, HasNoSideBeyondABoundary) {
  const SignedDistance square(shapes::square_grid(3));
  const SignedDistance::Values values =
      square(Points{{0.5, 0.5, 1.5, -1}, {0.5, 0.5, 0.5, -1}, {2, -2, 0.1, 0.1}});
  EXPECT_EQ(values.sided, (std::vector<char>{1, 1, 0, 0}));
  EXPECT_EQ(values.distance[0], 2);
  EXPECT_EQ(values.distance[1], -2);
  EXPECT_NEAR(values.distance[2], std::hypot(0.5, 0.1), 1e-15);
}

TEST(SignedDistance, HasNoSideAtAnEdgeOfFacesBackToBack) {
  TriangleMesh sheet = shapes::triangle();
  sheet.faces = Faces{{0, 0}, {1, 2}, {2, 1}};
  EXPECT_FALSE(SignedDistance(sheet)(Points(Vector3(0.5, -1, 0))).sided[0]);
}

TEST(SignedDistance, RefusesAnEmptyMesh) { EXPECT_THROW(SignedDistance({}), InvalidInput); }

TEST(SignedDistance, IsThatOfEveryPointAlone) {
  TriangleMesh open = shapes::icosphere(2);
  open.faces.conservativeResize(3, open.faces.cols() - 40);
  Points x(3, 4000);  // a walk in and out of the surface
  const Points steps = 0.15 * test::random_points(x.cols(), 8);
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    x.col(i) = i == 0 ? Vector3(0, 0, 0) : Vector3(0.99 * x.col(i - 1) + steps.col(i));
  x.col(77) = x.col(78) = open.vertices.col(3);
  for (const TriangleMesh& mesh :
       {shapes::icosphere(2), open, shapes::joined(shapes::icosphere(2), shapes::cube())}) {
    const SignedDistance surface(mesh);
    const SignedDistance::Values values = surface(x);
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      ASSERT_EQ(values.distance[static_cast<std::size_t>(i)], surface(x.col(i)).distance.front()) << i;
  }
}

}  // namespace
}  // namespace bespoke
