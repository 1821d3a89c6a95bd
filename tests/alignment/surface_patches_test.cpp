#include "bespoke/alignment/detail/surface_patches.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bespoke/error.h"
#include "bespoke/mesh/cavities.h"
#include "support/pocketed_ball.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(SurfacePatches, ShareOutTheWholeArea) {
  const TriangleMesh ball = shapes::icosphere(3);
  const SurfacePatches patches = make_surface_patches(ball, 100);
  EXPECT_EQ(patches.size(), 100);
  EXPECT_NEAR(patches.areas.sum(), 1, 1e-12);
  // Seeds a spacing r apart leave no vertex farther than r from a seed, and discs of radius r / 2 do not
  // overlap: r is about the spacing.
  for (Eigen::Index i = 0; i < ball.vertices.cols(); ++i) {
    const int patch = patches.patch_of_vertex[static_cast<std::size_t>(i)];
    ASSERT_GE(patch, 0);
    EXPECT_LT((ball.vertices.col(i) - patches.points.col(patch)).norm(), 2 * patches.spacing);
  }
}

TEST(SurfacePatches, MeasureTheMeanCurvatureOfABall) {
  const SurfacePatches patches = make_surface_patches(shapes::icosphere(4), 200);
  // Radius 1, curvature 1, whatever the unit; the patches' centroids lie a little inside.
  EXPECT_NEAR(patches.curvature.mean(), 1, 0.05);
  EXPECT_NEAR(patches.radius, 1, 0.03);
}

TEST(SurfacePatches, KeepTheSidesOfAThinPlateApart) {
  TriangleMesh top = shapes::square_grid(20), bottom = top;
  top.vertices.row(2).array() += 0.001;
  bottom.faces.row(0).swap(bottom.faces.row(1));
  const SurfacePatches patches = make_surface_patches(shapes::joined(top, bottom), 100);
  for (const auto& normal : patches.normals.colwise()) EXPECT_NEAR(std::abs(normal[2]), 1, 1e-9);
}

TEST(SurfacePatches, KnowOpenBoundaries) {
  EXPECT_EQ(make_surface_patches(shapes::icosphere(2), 50).on_boundary.sum(), 0);
  const SurfacePatches sheet = make_surface_patches(shapes::square_grid(20), 100);
  EXPECT_GT(sheet.on_boundary.sum(), 20);
  EXPECT_LT(sheet.on_boundary.sum(), 60);
}

TEST(SurfacePatches, HangTogetherAcrossComponents) {
  TriangleMesh far = shapes::cube();
  far.vertices.array() += 10;
  const SurfacePatches patches = make_surface_patches(shapes::joined(shapes::cube(), far), 60);
  std::vector<char> reached(static_cast<std::size_t>(patches.size()), 0);
  std::vector<int> waiting{0};
  while (!waiting.empty()) {
    const auto patch = static_cast<std::size_t>(waiting.back());
    waiting.pop_back();
    if (reached[patch]) continue;
    reached[patch] = 1;
    for (const int other : patches.neighbours[patch]) waiting.push_back(other);
  }
  for (const char flag : reached) EXPECT_EQ(flag, 1);
}

TEST(SurfacePatches, AreTheirMirrorImagesMirrorImage) {
  const SurfacePatches patches = make_surface_patches(shapes::cube(), 60);
  const SurfacePatches twice = mirrored(mirrored(patches));
  EXPECT_EQ(twice.points, patches.points);
  EXPECT_EQ(twice.axes, patches.axes);
  EXPECT_NEAR(mirrored(patches).axes.determinant(), 1, 1e-12);
}

TEST(SurfacePatches, RejectMeshesWithoutArea) {
  EXPECT_THROW(make_surface_patches(TriangleMesh{}, 10), InvalidInput);
}

TEST(SurfacePatches, HaveNoOpenAreaInThePocketOfABall) {
  const TriangleMesh mesh = shapes::pocketed_ball(9 * std::numbers::pi / 180);
  const SurfacePatches patches = make_surface_patches(mesh, 300, cavities_of(mesh).contains);
  EXPECT_NEAR(patches.open_areas.sum(), 1, 1e-12);
  for (Eigen::Index i = 0; i < patches.size(); ++i) {
    const double far = patches.points.col(i).norm();
    if (far < 0.7) {
      EXPECT_EQ(patches.open_areas[i], 0);
    }
    if (far > 0.98) {
      EXPECT_GT(patches.open_areas[i], patches.areas[i]);
    }
  }
}

}  // namespace
}  // namespace bespoke
