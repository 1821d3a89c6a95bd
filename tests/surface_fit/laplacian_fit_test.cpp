#include "bespoke/surface_fit/detail/laplacian_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/mesh_edges.h"
#include "support/arithmetic.h"
#include "support/fitting_scene.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::infinity;

struct LaplacianScene : test::FittingScene {
  SurfaceFit fit(SurfaceFitOptions options = {}) const {
    options.method = SurfaceFitMethod::laplacian;
    return FittingScene::fit(options);
  }
};

TEST(FitSurfaceLaplacian, LeavesAFittedSourceWhereItIs) {
  const TriangleMesh sphere = shapes::icosphere(2);
  const SurfaceFit fit = LaplacianScene{sphere, sphere}.fit();
  EXPECT_LT((fit.vertices - sphere.vertices).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(fit.summary.stop_reason, StopReason::converged);
  EXPECT_EQ(fit.summary.unmatched_vertices, 0u);
}

TEST(FitSurfaceLaplacian, BringsATranslatedSphereBack) {
  const TriangleMesh sphere = shapes::icosphere(3);
  LaplacianScene scene{sphere,
                       shapes::moved(shapes::icosphere(4), {Matrix3::Identity(), Vector3(0.05, 0.1, -0.02)})};
  // A stiff surface can only move as one, so that its vertices do not slide.
  SurfaceFitOptions options;
  options.stiffness = 1e4;
  const SurfaceFit fit = scene.fit(options);
  EXPECT_GT(fit.summary.before.max, 0.1);
  EXPECT_LT(fit.summary.after.max, 1e-12);
  const Points back = fit.vertices.colwise() - Vector3(0.05, 0.1, -0.02);
  EXPECT_LT((back.colwise().norm().array() - 1).abs().maxCoeff(), 0.005);
  EXPECT_LT((back - sphere.vertices).colwise().norm().maxCoeff(), 0.01);
  for (const double confidence : fit.confidence) EXPECT_EQ(confidence, 1);
}

TEST(FitSurfaceLaplacian, KeepsExactAnchors) {
  const TriangleMesh sphere = shapes::icosphere(3);
  LaplacianScene scene{sphere, shapes::moved(sphere, {1.1 * Matrix3::Identity(), Vector3::Zero()})};
  scene.anchor_sources = sphere.vertices.col(3);
  scene.anchor_targets = 1.1 * sphere.vertices.col(9);
  scene.anchor_weights = Eigen::VectorXd::Constant(1, infinity);
  EXPECT_EQ(scene.fit().vertices.col(3), scene.anchor_targets.col(0));
}

TEST(FitSurfaceLaplacian, TurnsNoFaceOver) {
  // Four source vertices a target face, and bumps that no displacement field of one step can follow.
  TriangleMesh bumpy = shapes::icosphere(3);
  for (Eigen::Index i = 0; i < bumpy.vertices.cols(); ++i) {
    const Vector3 x = bumpy.vertices.col(i);
    bumpy.vertices.col(i) *= 1 + 0.1 * std::sin(9 * x.x()) * std::cos(8 * x.y());
  }
  const TriangleMesh source = shapes::icosphere(4);
  const SurfaceFit fit = LaplacianScene{source, bumpy}.fit();
  const Points normals = face_normals({fit.vertices, source.faces});
  for (Eigen::Index face = 0; face < normals.cols(); ++face)
    EXPECT_GT(normals.col(face).dot(fit.vertices.col(source.faces(0, face))), 0);
  EXPECT_LT(fit.summary.after.p95, 1e-9);
}

TEST(FitSurfaceLaplacian, DoesNotPileUpOnTheBoundaryOfAShorterTarget) {
  TriangleMesh strip = shapes::square_grid(20);
  TriangleMesh shorter = strip;
  shorter.vertices.row(0) *= 0.8;
  shorter.vertices.row(2).setConstant(0.03);
  const LaplacianScene scene{strip, shorter};
  const SurfaceFit fit = scene.fit();
  const Points moved = fit.vertices - strip.vertices;
  EXPECT_GT(fit.summary.unmatched_vertices, 0u);
  EXPECT_LT(moved.topRows(2).cwiseAbs().maxCoeff(), 1e-9);
  for (Eigen::Index i = 0; i < moved.cols(); ++i) EXPECT_NEAR(moved(2, i), 0.03, 1e-3);
  EXPECT_EQ(fit.confidence.front(), 0);  // a corner: on the target's boundary
}

TEST(FitSurfaceLaplacian, WorksOnPiecesSingleTrianglesAndLooseVertices) {
  TriangleMesh pieces = shapes::joined(shapes::icosphere(2), shapes::triangle());
  pieces.vertices.rightCols(3).colwise() += Vector3(3, 0, 0);
  pieces.vertices.conservativeResize(3, pieces.vertices.cols() + 1);
  pieces.vertices.rightCols(1) = Vector3(7, 7, 7);
  TriangleMesh target = pieces;
  target.vertices.row(2).array() += 0.01;
  const SurfaceFit fit = LaplacianScene{pieces, target}.fit();
  EXPECT_TRUE(fit.vertices.allFinite());
  EXPECT_EQ(fit.vertices.rightCols(1), pieces.vertices.rightCols(1));

  const SurfaceFit single = LaplacianScene{shapes::triangle(), shapes::triangle()}.fit();
  EXPECT_TRUE(single.vertices.isApprox(shapes::triangle().vertices));
}

TEST(FitSurfaceLaplacian, SaysWhyItStopped) {
  const TriangleMesh sphere = shapes::icosphere(2);
  LaplacianScene scene{sphere, shapes::moved(sphere, {1.2 * Matrix3::Identity(), Vector3::Zero()})};
  SurfaceFitOptions options;
  options.max_iterations = 1;
  const SurfaceFit fit = scene.fit(options);
  EXPECT_EQ(fit.summary.iterations, 1);
  EXPECT_EQ(fit.summary.stop_reason, StopReason::iteration_cap);
  EXPECT_NE(to_string(fit.summary).find("iteration cap"), std::string::npos);
}

// ---- the printed method

SurfaceFit fit_as_printed(const LaplacianScene& scene, int max_iterations = 100) {
  SurfaceFitOptions options;
  options.laplacian = no_additions;
  options.max_iterations = max_iterations;
  return scene.fit(options);
}

TriangleMesh bumpy_sphere(int levels) {
  TriangleMesh mesh = shapes::icosphere(levels);
  for (auto&& x : mesh.vertices.colwise()) x *= 1.1 + 0.1 * std::sin(5 * x[0]) * std::cos(4 * x[1]);
  return mesh;
}

/// Closest points of all vertices on faces whose normals lie within 90 degrees.
Points closest_compatible(const TriangleMesh& moving, const TriangleMesh& target) {
  const ClosestPointTree tree(target);
  const Points normals = vertex_normals(moving);
  Points found = moving.vertices;
  for (Eigen::Index i = 0; i < found.cols(); ++i) {
    ClosestPointQuery query;
    query.normal = normals.col(i);
    if (const auto point = tree.closest(moving.vertices.col(i), query)) found.col(i) = point->point;
  }
  return found;
}

/// I + L of Eq. 13, dense: 1 + valence on the diagonal, -1 for each neighbour.
Eigen::MatrixXd printed_matrix(const TriangleMesh& mesh) {
  const Eigen::Index count = mesh.vertices.cols();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(count, count);
  for (const MeshEdge& edge : mesh_edges(mesh).edges) {
    matrix(edge.a, edge.a) += 1;
    matrix(edge.b, edge.b) += 1;
    matrix(edge.a, edge.b) -= 1;
    matrix(edge.b, edge.a) -= 1;
  }
  return matrix;
}

TEST(FitSurfaceLaplacian, AsPrintedIsEquation13RepeatedAndASnap) {
  const TriangleMesh target = bumpy_sphere(3);
  const LaplacianScene scene{shapes::icosphere(2), target};
  const Eigen::MatrixXd inverse = printed_matrix(scene.source).inverse();
  TriangleMesh moving = scene.source;
  for (int iteration = 1; iteration <= 4; ++iteration) {
    moving.vertices += (closest_compatible(moving, target) - moving.vertices) * inverse;
    const SurfaceFit fit = fit_as_printed(scene, iteration);
    EXPECT_EQ(fit.summary.iterations, iteration);
    EXPECT_EQ(fit.summary.stiffness, 1);
    EXPECT_TRUE(fit.vertices.isApprox(closest_compatible(moving, target), 1e-10));
  }
}

TEST(FitSurfaceLaplacian, AsPrintedStopsWhenTheDisplacementsAreWithinEpsilonAndNotBefore) {
  const TriangleMesh sphere = shapes::icosphere(2);
  const SurfaceFit there = fit_as_printed(LaplacianScene{sphere, sphere});
  EXPECT_EQ(there.summary.stop_reason, StopReason::converged);
  EXPECT_EQ(there.summary.iterations, 0);

  // The part of the source beyond the end of the target has a way to go, and takes several steps of Eq. 13.
  TriangleMesh half = shapes::square_grid(6);
  half.vertices.row(0) /= 2;
  const LaplacianScene scene{shapes::square_grid(6), half};
  const SurfaceFit capped = fit_as_printed(scene, 5);
  EXPECT_EQ(capped.summary.iterations, 5);
  EXPECT_EQ(capped.summary.stop_reason, StopReason::unprinted_cap);
  const SurfaceFit converged = fit_as_printed(scene);
  EXPECT_EQ(converged.summary.stop_reason, StopReason::converged);
  EXPECT_GT(converged.summary.iterations, 5);
}

TEST(FitSurfaceLaplacian, AsPrintedLetsTheWarpAloneKnowTheAnchors) {
  const TriangleMesh sphere = shapes::icosphere(3);
  LaplacianScene scene{sphere, bumpy_sphere(4)};
  const SurfaceFit without = fit_as_printed(scene, 5);
  scene.anchor_sources = sphere.vertices.leftCols(4);
  scene.anchor_targets = scene.target.vertices.leftCols(4);
  scene.anchor_weights = Eigen::VectorXd::Constant(4, infinity);
  EXPECT_EQ(fit_as_printed(scene, 5).vertices, without.vertices);
}

TEST(FitSurfaceLaplacian, AsPrintedTakesTheBoundaryForACounterpart) {
  const TriangleMesh strip = shapes::square_grid(10);
  TriangleMesh shorter = strip;
  shorter.vertices.row(0) *= 0.8;
  const SurfaceFit printed = fit_as_printed(LaplacianScene{strip, shorter});
  EXPECT_EQ(printed.summary.unmatched_vertices, 0u);
  EXPECT_NEAR(printed.vertices.row(0).maxCoeff(), 0.8, 1e-12);
  EXPECT_NEAR((LaplacianScene{strip, shorter}.fit().vertices.row(0).maxCoeff()), 1, 1e-9);
}

TEST(FitSurfaceLaplacian, ScaledStiffnessGrowsWithTheVerticesUnlessToldOtherwise) {
  const TriangleMesh fine = shapes::icosphere(4), coarse = shapes::icosphere(1);
  EXPECT_GT((LaplacianScene{fine, fine}.fit().summary.stiffness), 1);
  EXPECT_EQ((LaplacianScene{coarse, coarse}.fit().summary.stiffness), 1);
  SurfaceFitOptions options;
  options.stiffness = 7;
  EXPECT_EQ((LaplacianScene{fine, fine}.fit(options).summary.stiffness), 7);
}

}  // namespace
}  // namespace bespoke
