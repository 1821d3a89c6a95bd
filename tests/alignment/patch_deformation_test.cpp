#include "bespoke/alignment/detail/patch_deformation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace bespoke {
namespace {

/// Bent about the y axis by `angle` over its length.
TriangleMesh bent_bar(double angle) {
  TriangleMesh bar = shapes::icosphere(3);
  bar.vertices = Vector3(4, 1, 0.6).asDiagonal() * bar.vertices;
  if (angle == 0) return bar;
  const double radius = 8 / angle;
  for (auto&& vertex : bar.vertices.colwise()) {
    const double turn = vertex[0] / radius, height = radius + vertex[2];
    vertex = Vector3(height * std::sin(turn), vertex[1], height * std::cos(turn) - radius);
  }
  return bar;
}

TEST(PatchDeformation, LeavesACopyWhereTheSimilarityPutsIt) {
  const TriangleMesh bar = bent_bar(0);
  const SurfacePatches source = make_surface_patches(bar, 200);
  Similarity start;
  start.scale = 4;  // a power of two: the same patches, bit for bit
  const SurfacePatches target = make_surface_patches({start * bar.vertices, bar.faces}, 200);
  const PatchDeformation deformed = deform_patches(source, target, start);
  EXPECT_LT((deformed.points - target.points).colwise().norm().mean(), 0.1 * target.spacing);
  EXPECT_GT(deformed.matches.matched(), 0.9);
}

TEST(PatchDeformation, FollowsABend) {
  const TriangleMesh bar = bent_bar(0), bent = bent_bar(0.8);
  const SurfacePatches source = make_surface_patches(bar, 300), target = make_surface_patches(bent, 300);
  const PatchDeformation deformed = deform_patches(source, target, Similarity{});
  const Points places = deformed_vertices(bar, source, deformed, Similarity{});
  const double before = (bar.vertices - bent.vertices).colwise().norm().mean();
  EXPECT_LT((places - bent.vertices).colwise().norm().mean(), 0.4 * before);
  EXPECT_GT(deformed.bending, 0.01);
}

TEST(PatchDeformation, JudgesTheWrongSideWorse) {
  TriangleMesh pear = shapes::icosphere(3);
  for (auto&& vertex : pear.vertices.colwise()) vertex *= 1 + 0.5 * std::exp(3 * (vertex[2] - 1));
  const SurfacePatches patches = make_surface_patches(pear, 200);
  Similarity half_turn;
  half_turn.rotation = Vector3(1, -1, -1).asDiagonal();
  EXPECT_LT(deform_patches(patches, patches, Similarity{}).misfit(),
            0.7 * deform_patches(patches, patches, half_turn).misfit());
}

}  // namespace
}  // namespace bespoke
