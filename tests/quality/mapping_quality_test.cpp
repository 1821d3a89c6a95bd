#include "bespoke/quality/mapping_quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "bespoke/error.h"
#include "support/analytic_map.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

AffineMap scaling(double factor) { return {factor * Matrix3::Identity(), Vector3::Zero()}; }

struct Spheres {
  TriangleMesh source = shapes::icosphere(4);
  TriangleMesh target = shapes::icosphere(4);
  SignedDistance from_source{source};
  SignedDistance from_target{target};
  Bodies bodies{source, target, from_source, from_target};
};

TEST(ProductQuality, OfAShellThatShrinksIntoTheBody) {
  const Spheres spheres;
  const TriangleMesh shell = shapes::moved(shapes::icosphere(3), scaling(1.1));
  const ProductQuality kept = product_quality(shell, shell.vertices, spheres.bodies);
  EXPECT_NEAR(kept.clearance_before.median, 0.1, 0.003);
  EXPECT_EQ(kept.clearance_change.max, 0);
  EXPECT_EQ(kept.penetration_after.vertices, 0u);
  EXPECT_EQ(kept.penetration_after.deepest, 0);
  EXPECT_EQ(kept.unsided_vertices, 0u);

  const ProductQuality shrunk = product_quality(shell, shell.vertices * (0.9 / 1.1), spheres.bodies);
  EXPECT_NEAR(shrunk.clearance_after.median, -0.1, 0.003);
  EXPECT_NEAR(shrunk.clearance_change.p95, 0.2, 0.005);
  EXPECT_EQ(shrunk.penetration_before.vertices, 0u);
  EXPECT_EQ(shrunk.penetration_after.vertices, 642u);
  EXPECT_EQ(shrunk.penetration_after.area_share, 1);
  EXPECT_NEAR(shrunk.penetration_after.deepest, 0.11, 0.01);
  EXPECT_NEAR(shrunk.distortion.edge_length.median, 0.9 / 1.1, 1e-12);
}

TEST(ProductQuality, TellsNewPenetrationFromOld) {
  const Spheres spheres;
  const TriangleMesh shell = shapes::moved(shapes::icosphere(3), scaling(1.1));
  const ProductQuality shrunk = product_quality(shell, shell.vertices * (0.9 / 1.1), spheres.bodies);
  EXPECT_EQ(shrunk.new_penetration.share, 1);
  EXPECT_NEAR(shrunk.new_penetration.deepest, 0.11, 0.01);
  EXPECT_TRUE(shrunk.new_penetration.is_notable());

  const TriangleMesh cavity = shapes::moved(shapes::icosphere(3), scaling(0.95));
  const ProductQuality deeper = product_quality(cavity, cavity.vertices * 0.9, spheres.bodies);
  EXPECT_EQ(deeper.penetration_after.area_share, 1);
  EXPECT_EQ(deeper.new_penetration.share, 0);

  // One of two equal shells penetrates: half of the area, and of the vertices.
  const AffineMap aside{1.1 * Matrix3::Identity(), {5, 0, 0}};
  const TriangleMesh two = shapes::joined(shell, shapes::moved(shapes::icosphere(3), aside));
  Points after = two.vertices;
  after.leftCols(shell.vertices.cols()) *= 0.9 / 1.1;
  EXPECT_NEAR(product_quality(two, after, spheres.bodies).new_penetration.share, 0.5, 0.001);
  EXPECT_EQ(
      product_quality(TriangleMesh{two.vertices, Faces(3, 0)}, after, spheres.bodies).new_penetration.share,
      0.5);
}

TEST(ProductQuality, SeesFacesInsideWhoseVerticesAreNot) {
  const Spheres spheres;
  TriangleMesh sheet = shapes::moved(shapes::square_grid(1), {4 * Matrix3::Identity(), {-2, -2, 0}});
  const ProductQuality quality = product_quality(sheet, sheet.vertices, spheres.bodies);
  EXPECT_EQ(quality.penetration_after.vertices, 0u);
  EXPECT_NEAR(quality.penetration_after.area_share, std::numbers::pi / 16, 0.002);
  EXPECT_NEAR(quality.penetration_after.deepest, 1, 0.03);
}

TEST(ProductQuality, CountsSelfIntersectionsBeforeAndAfter) {
  const Spheres spheres;
  const AffineMap apart{Matrix3::Identity(), {5, 0, 0}}, crossing{Matrix3::Identity(), {0.81, 0.37, 0.23}};
  const TriangleMesh before =
      shapes::joined(shapes::icosphere(1), shapes::moved(shapes::icosphere(1), apart));
  const TriangleMesh after =
      shapes::joined(shapes::icosphere(1), shapes::moved(shapes::icosphere(1), crossing));
  const ProductQuality quality = product_quality(before, after.vertices, spheres.bodies);
  EXPECT_EQ(quality.self_intersections_before, 0u);
  EXPECT_GT(quality.self_intersections_after, 0u);
}

TEST(ProductQuality, OfAPointSetHasClearanceOnly) {
  const Spheres spheres;
  const TriangleMesh points{2 * shapes::icosphere(1).vertices, Faces(3, 0)};
  const ProductQuality quality = product_quality(points, points.vertices, spheres.bodies);
  EXPECT_EQ(quality.clearance_before.count, 42u);
  EXPECT_EQ(quality.faces, 0u);
  EXPECT_EQ(quality.penetration_after.area_share, 0);
  EXPECT_EQ(quality.distortion.edge_length.count, 0u);
}

// A line through a ball of radius 1: half of its length 4 is inside, which no vertex is.
TEST(ProductQuality, MeasuresLines) {
  const Spheres spheres;
  const Points line{{-2, 2}, {0, 0}, {0, 0}};
  const MeasuredProduct before(TriangleMesh{2 * line, Faces(3, 0)}, {0, 1});
  const ProductQuality quality = product_quality(before, line, spheres.bodies);
  EXPECT_EQ(quality.lines, 1u);
  EXPECT_EQ(quality.line_lengths.count, 1u);
  EXPECT_EQ(quality.line_lengths.median, 0.5);
  EXPECT_EQ(quality.penetration_after.vertices, 0u);
  EXPECT_NEAR(quality.penetration_before.line_share, 0.25, 0.002);
  EXPECT_NEAR(quality.penetration_after.line_share, 0.5, 0.002);
  EXPECT_NEAR(quality.penetration_after.deepest, 1, 0.01);
  EXPECT_NEAR(quality.new_penetration.share, 0.25, 0.002);
}

TEST(ProductQuality, LeavesOutVerticesBeyondABoundary) {
  const TriangleMesh square = shapes::square_grid(3);
  const SignedDistance from_square(square);
  const Points x{{0.5, 2}, {0.5, 2}, {0.25, 0.25}};
  const ProductQuality quality =
      product_quality(TriangleMesh{x, Faces(3, 0)}, x, {square, square, from_square, from_square});
  EXPECT_EQ(quality.unsided_vertices, 1u);
  EXPECT_EQ(quality.clearance_after.count, 1u);
  EXPECT_EQ(quality.clearance_after.max, 0.25);
}

TEST(ProductQuality, RefusesWhatDoesNotBelongTogether) {
  const Spheres spheres;
  const TriangleMesh cube = shapes::cube();
  EXPECT_THROW(product_quality(cube, Points(3, 2), spheres.bodies), InvalidInput);
  Points broken = cube.vertices;
  broken(0, 0) = std::nan("");
  EXPECT_THROW(product_quality(cube, broken, spheres.bodies), InvalidInput);
}

struct Case {
  TriangleMesh source = shapes::icosphere(3);
  AnalyticMap elastic{{}, scaling(2)};
  RigidTransform target_from_source{Eigen::AngleAxisd(0.5, Vector3(0, 0, 1)).toRotationMatrix(), {3, 4, 5}};
  TriangleMesh target{target_from_source * elastic(source.vertices), source.faces};
  Points anchor_sources = Vector3(1, 0, 0);
  Points anchor_targets = (target_from_source * Vector3(2, 0, 0)) + Vector3(0, 0, 0.5);
  std::vector<NamedProduct> products{{"shell.obj", shapes::moved(source, scaling(1.5))}};

  MappingQuality measure() const {
    return mapping_quality(
        {source, target, elastic, target_from_source, anchor_sources, anchor_targets, products});
  }
};

TEST(MappingQuality, OfAnExactMapIsPerfectButForWhatItIsGiven) {
  const MappingQuality quality = Case().measure();
  EXPECT_DOUBLE_EQ(quality.anchor_residuals.max, 0.5);
  EXPECT_LT(quality.surfaces.hausdorff, 1e-14);
  EXPECT_EQ(quality.distortion.min_determinant, 8);
  EXPECT_EQ(quality.flipped_faces, 0u);
  EXPECT_EQ(quality.source_faces, 1280u);
  ASSERT_EQ(quality.products.size(), 1u);
  EXPECT_NEAR(quality.products[0].distortion.edge_length.p1, 2, 1e-12);
  EXPECT_NEAR(quality.products[0].clearance_after.median, 2 * quality.products[0].clearance_before.median,
              1e-12);
}

TEST(MappingQuality, OfASphereOntoALargerOneIsTheDifferenceOfRadii) {
  Case spheres;
  spheres.target.vertices = spheres.target_from_source * Points(3 * spheres.source.vertices);
  const MappingQuality quality = spheres.measure();
  EXPECT_NEAR(quality.surfaces.a_to_b.median, 1, 0.02);
  EXPECT_NEAR(quality.surfaces.hausdorff, 1, 0.02);
  // The shell at 1.5 goes to radius 3, half outside of the source and on the target.
  EXPECT_NEAR(quality.products[0].clearance_before.median, 0.5, 0.01);
  EXPECT_NEAR(quality.products[0].clearance_after.median, 0, 1e-12);
  EXPECT_EQ(quality.products[0].new_penetration.share, 0);
}

TEST(MappingQuality, NamesTheProductAtFault) {
  Case broken;
  broken.products[0].mesh.vertices(0, 0) = std::nan("");
  try {
    broken.measure();
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()).rfind("shell.obj: ", 0), 0u) << error.what();
  }
}

TEST(MappingQuality, RefusesAnchorsWithoutCounterparts) {
  Case broken;
  broken.anchor_targets = Points(3, 0);
  EXPECT_THROW(broken.measure(), InvalidInput);
}

}  // namespace
}  // namespace bespoke
