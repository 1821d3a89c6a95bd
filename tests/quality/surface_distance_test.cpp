#include "bespoke/quality/surface_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bespoke/error.h"
#include "bespoke/quality/detail/surface_samples.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

AffineMap scaling(double x, double y, double z) {
  return {Vector3(x, y, z).asDiagonal().toDenseMatrix(), Vector3::Zero()};
}

AffineMap moved_by(double x, double y, double z) { return {Matrix3::Identity(), {x, y, z}}; }

TEST(SampleSurface, StandsForEqualAreas) {
  // A face of 3/4 of the area, and one of 1/4, and one of none.
  TriangleMesh mesh;
  mesh.vertices = Points{{0, 3, 0, -1, 9}, {0, 0, 1, 0, 9}, {0, 0, 0, 0, 9}};
  mesh.faces = Faces{{0, 4, 0}, {1, 4, 2}, {2, 4, 3}};
  const SurfaceSamples samples = sample_surface(mesh, 1000);
  ASSERT_EQ(samples.faces.size(), 1000u);
  EXPECT_EQ(std::count(samples.faces.begin(), samples.faces.end(), 0), 750);
  EXPECT_EQ(std::count(samples.faces.begin(), samples.faces.end(), 1), 0);
  EXPECT_TRUE(std::is_sorted(samples.faces.begin(), samples.faces.end()));
  EXPECT_GE(samples.barycentric.minCoeff(), 0);
  EXPECT_LT((samples.barycentric.colwise().sum().array() - 1).abs().maxCoeff(), 1e-15);
}

TEST(SampleSurface, IntegratesOverOneFaceAndOverMany) {
  // Mean of x², y² and xy over the unit square, and of x and x² over the triangle below its diagonal.
  const TriangleMesh grid = shapes::square_grid(7);
  const Points on_grid = positions(sample_surface(grid, 20000), grid);
  EXPECT_NEAR(on_grid.row(0).squaredNorm() / 20000, 1.0 / 3, 2e-4);
  EXPECT_NEAR(on_grid.row(1).squaredNorm() / 20000, 1.0 / 3, 2e-4);
  EXPECT_NEAR(on_grid.row(0).dot(on_grid.row(1)) / 20000, 0.25, 2e-4);
  const TriangleMesh triangle = shapes::triangle();
  const Points on_triangle = positions(sample_surface(triangle, 20000), triangle);
  EXPECT_NEAR(on_triangle.row(0).mean(), 1.0 / 3, 2e-4);
  EXPECT_NEAR(on_triangle.row(0).squaredNorm() / 20000, 1.0 / 6, 2e-4);
}

TEST(SampleSurface, FollowsADeformation) {
  const TriangleMesh sphere = shapes::icosphere(2);
  const AffineMap map{Matrix3{{1, 2, 0}, {0, 1, 0}, {1, 0, 3}}, {1, 2, 3}};
  const SurfaceSamples samples = sample_surface(sphere, 500);
  EXPECT_LT((positions(samples, shapes::moved(sphere, map)) - map * positions(samples, sphere))
                .cwiseAbs()
                .maxCoeff(),
            1e-14);
}

TEST(SampleSurface, OfNoAreaIsEmpty) {
  EXPECT_TRUE(sample_surface({}, 10).faces.empty());
  EXPECT_TRUE(sample_surface(shapes::moved(shapes::triangle(), scaling(1, 0, 1)), 10).faces.empty());
}

TEST(SurfaceDistance, OfASurfaceFromItselfIsZero) {
  const SurfaceDistance distance =
      surface_distance(shapes::icosphere(3), shapes::icosphere(3), {.samples = 1000});
  EXPECT_LT(distance.hausdorff, 1e-15);
  EXPECT_EQ(distance.a_to_b.count, 1000u);
}

TEST(SurfaceDistance, OfParallelSquaresIsTheirGap) {
  const TriangleMesh square = shapes::square_grid(5);
  const SurfaceDistance distance = surface_distance(square, shapes::moved(square, moved_by(0, 0, 0.25)));
  for (const Statistics& one_way : {distance.a_to_b, distance.b_to_a}) {
    EXPECT_EQ(one_way.min, 0.25);
    EXPECT_EQ(one_way.max, 0.25);
  }
  EXPECT_EQ(distance.hausdorff, 0.25);
}

TEST(SurfaceDistance, DiffersByDirectionWhereOneSurfaceEnds) {
  // The part of the doubled square beyond the square is an L; its corner is √2 away.
  const TriangleMesh square = shapes::square_grid(5);
  const SurfaceDistance distance = surface_distance(square, shapes::moved(square, scaling(2, 2, 1)));
  EXPECT_LT(distance.a_to_b.max, 1e-15);
  EXPECT_NEAR(distance.b_to_a.max, std::sqrt(2), 0.02);
  EXPECT_DOUBLE_EQ(distance.hausdorff, std::sqrt(2));
  // Three quarters of the samples lie beyond; those nearer than d make up ((1 + d)² − (1 − π/4) d²) / 4.
  EXPECT_NEAR(distance.b_to_a.p95, 1.0196, 0.01);
}

TEST(SurfaceDistance, OfSpheresIsTheDifferenceOfTheirRadii) {
  const TriangleMesh sphere = shapes::icosphere(4);
  const SurfaceDistance distance =
      surface_distance(sphere, shapes::moved(sphere, scaling(1.5, 1.5, 1.5)), {.samples = 20000});
  EXPECT_NEAR(distance.a_to_b.median, 0.5, 0.005);
  EXPECT_NEAR(distance.b_to_a.median, 0.5, 0.005);
  EXPECT_NEAR(distance.hausdorff, 0.5, 0.005);
}

TEST(SurfaceDistance, RefusesWhatCannotBeSampled) {
  const TriangleMesh square = shapes::square_grid(1);
  EXPECT_THROW(surface_distance(square, {}), InvalidInput);
  EXPECT_THROW(surface_distance(square, square, {.samples = 0}), InvalidInput);
  EXPECT_THROW(surface_distance(square, shapes::moved(square, scaling(1, 0, 0))), InvalidInput);
}

}  // namespace
}  // namespace bespoke
