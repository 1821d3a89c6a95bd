#include "bespoke/quality/detail/winding_number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bespoke/error.h"
#include "bespoke/quality/signed_distance.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TriangleMesh flipped(TriangleMesh mesh) {
  mesh.faces.row(1).swap(mesh.faces.row(2));
  return mesh;
}

TriangleMesh sphere(double radius, int levels = 4) {
  return shapes::moved(shapes::icosphere(levels), {radius * Matrix3::Identity(), Vector3::Zero()});
}

/// Around the z axis, from z = -height / 2 to height / 2; without caps.
TriangleMesh tube(double radius, double height, int around = 96, int along = 24) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, around * (along + 1));
  for (int j = 0; j <= along; ++j)
    for (int i = 0; i < around; ++i) {
      const double turn = 2 * std::numbers::pi * i / around;
      mesh.vertices.col(j * around + i) << radius * std::cos(turn), radius * std::sin(turn),
          height * (double(j) / along - 0.5);
    }
  mesh.faces.resize(3, 2 * around * along);
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const int a = j * around + i, b = j * around + (i + 1) % around, c = a + around, d = b + around;
      mesh.faces.col(2 * (j * around + i)) << a, b, d;
      mesh.faces.col(2 * (j * around + i) + 1) << a, d, c;
    }
  return mesh;
}

/// The unit sphere without what lies above z = height.
TriangleMesh open_sphere(double height) {
  TriangleMesh mesh = shapes::icosphere(4);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    if (mesh.vertices(2, mesh.faces(0, face)) < height && mesh.vertices(2, mesh.faces(1, face)) < height &&
        mesh.vertices(2, mesh.faces(2, face)) < height)
      kept.push_back(face);
  mesh.faces = mesh.faces(Eigen::all, kept).eval();
  return mesh;
}

constexpr double approximation = 0.02;

TEST(WindingNumber, OfNestedSpheresCountsThem) {
  const WindingNumber both(shapes::joined(sphere(1), sphere(0.5)));
  const WindingNumber cavity(shapes::joined(sphere(1), flipped(sphere(0.5))));
  const Points directions = test::random_points(200, 3).colwise().normalized();
  for (const auto& direction : directions.colwise()) {
    EXPECT_NEAR(both(0.3 * direction), 2, approximation);
    EXPECT_NEAR(both(0.7 * direction), 1, approximation);
    EXPECT_NEAR(both(1.2 * direction), 0, approximation);
    EXPECT_NEAR(cavity(0.3 * direction), 0, approximation);
    EXPECT_NEAR(cavity(0.7 * direction), 1, approximation);
    for (const double radius : {0.3, 0.49, 0.52, 0.7, 0.98, 1.02, 1.2}) {
      EXPECT_EQ(both.whole(radius * direction), radius < 0.5 ? 2 : radius < 1 ? 1 : 0) << radius;
      EXPECT_EQ(cavity.whole(radius * direction), 0.5 < radius && radius < 1 ? 1 : 0) << radius;
    }
  }
}

TEST(WindingNumber, OfATubeIsTheShareOfTheViewThatItFills) {
  constexpr double radius = 1, height = 3;
  const WindingNumber open(tube(radius, height));
  for (const double z : {0.0, 0.5, 1.0, 1.4, 2.0}) {
    // On the axis an end at distance d takes (1 - d / √(d² + r²)) / 2 of the view; behind the point it counts
    // against.
    const auto end = [&](double d) { return std::copysign(1 - std::abs(d) / std::hypot(d, radius), d) / 2; };
    const double expected = (z < height / 2 ? 1 : 0) - end(height / 2 - z) - end(height / 2 + z);
    EXPECT_NEAR(open({0, 0, z}), expected, approximation) << z;
  }
}

TEST(WindingNumber, IsASumOverFaces) {
  const TriangleMesh sheet = shapes::square_grid(20), ball = sphere(0.7);
  const WindingNumber a(sheet), b(ball), both(shapes::joined(sheet, ball));
  const Points places = test::random_points(300, 4);
  for (const auto& x : places.colwise()) EXPECT_NEAR(both(x), a(x) + b(x), 2 * approximation);
}

TEST(WindingNumber, RefusesAnEmptyMesh) { EXPECT_THROW(WindingNumber({}), InvalidInput); }

std::vector<double> distances_from(const TriangleMesh& mesh, const Points& x) {
  return SignedDistance(mesh)(x).distance;
}

TEST(SignedDistance, BetweenNestedShellsIsInside) {
  const TriangleMesh shells = shapes::joined(sphere(1), sphere(0.5));
  for (const double distance : distances_from(shells, sphere(0.7, 3).vertices))
    EXPECT_NEAR(distance, -0.2, 0.01);
  for (const double distance : distances_from(shells, sphere(0.3, 3).vertices))
    EXPECT_NEAR(distance, -0.2, 0.01);
}

TEST(SignedDistance, WithinACavityIsOutside) {
  const TriangleMesh hollow = shapes::joined(sphere(1), flipped(sphere(0.5)));
  for (const double distance : distances_from(hollow, sphere(0.3, 3).vertices))
    EXPECT_NEAR(distance, 0.2, 0.01);
  for (const double distance : distances_from(hollow, sphere(0.9, 3).vertices))
    EXPECT_NEAR(distance, -0.1, 0.01);
}

TEST(SignedDistance, OfASurfaceThatIsInsideOutHasTheSidesOfTheBody) {
  for (const double distance : distances_from(flipped(sphere(1)), sphere(0.8, 3).vertices))
    EXPECT_NEAR(distance, -0.2, 0.01);
  for (const double distance : distances_from(flipped(sphere(1)), sphere(1.2, 3).vertices))
    EXPECT_NEAR(distance, 0.2, 0.01);
}

TEST(SignedDistance, OfATubeIsThatFromItsWall) {
  const TriangleMesh wall = tube(1, 4);
  for (const double distance : distances_from(wall, tube(0.7, 3, 20, 5).vertices))
    EXPECT_NEAR(distance, -0.3, 0.002);
  for (const double distance : distances_from(wall, tube(1.4, 3, 20, 5).vertices))
    EXPECT_NEAR(distance, 0.4, 0.002);
}

TEST(SignedDistance, BelowAHoleIsInside) {
  // The hole's rim is the nearest place there.
  const TriangleMesh open = open_sphere(0.9);
  const SignedDistance::Values values = SignedDistance(open)(Points{{0, 0}, {0, 0}, {0.7, 1.1}});
  EXPECT_FALSE(values.sided[0]);
  EXPECT_LT(values.distance[0], -0.3);
  EXPECT_GT(values.distance[1], 0.3);
}

TEST(SignedDistance, InFrontOfASurfaceWithinAnOpenBodyIsInside) {
  const TriangleMesh open = shapes::joined(open_sphere(0.9), sphere(0.3));
  for (const double distance : distances_from(open, sphere(0.4, 2).vertices))
    EXPECT_NEAR(distance, -0.1, 0.01);
}

}  // namespace
}  // namespace bespoke
