#include "bespoke/surface_fit/detail/laplacian_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>

#include "bespoke/error.h"
#include "support/fitting_scene.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::random_points;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Eq. 11, summed as it is written.
struct Energy {
  TriangleMesh mesh;
  std::vector<DisplacementAnchor> anchors;
  double stiffness = 1;
  Points wished;
  std::vector<char> matched;
  Points anchor_wished;

  double operator()(const Points& displacement) const {
    double energy = 0;
    const VertexAdjacency adjacency = vertex_adjacency(mesh);
    for (int i = 0; i < displacement.cols(); ++i) {
      if (matched[static_cast<std::size_t>(i)]) energy += (displacement.col(i) - wished.col(i)).squaredNorm();
      for (int k = adjacency.start[static_cast<std::size_t>(i)];
           k < adjacency.start[static_cast<std::size_t>(i) + 1]; ++k) {
        const int j = adjacency.neighbours[static_cast<std::size_t>(k)];
        if (i < j) energy += stiffness * (displacement.col(i) - displacement.col(j)).squaredNorm();
      }
    }
    for (std::size_t k = 0; k < anchors.size(); ++k) {
      Vector3 at = Vector3::Zero();
      for (int corner = 0; corner < 3; ++corner)
        at += anchors[k].barycentric[corner] * displacement.col(anchors[k].vertices[corner]);
      energy += anchors[k].weight * (at - anchor_wished.col(static_cast<Eigen::Index>(k))).squaredNorm();
    }
    return energy;
  }
};

Energy energy_on(const TriangleMesh& mesh, double stiffness) {
  Energy energy;
  energy.mesh = mesh;
  energy.stiffness = stiffness;
  energy.wished = random_points(mesh.vertices.cols(), 1);
  energy.matched.assign(static_cast<std::size_t>(mesh.vertices.cols()), 1);
  energy.anchor_wished.resize(3, 0);
  return energy;
}

/// The energy is quadratic, so that central differences of step 1 give its gradient exactly.
double largest_gradient(const Energy& energy, Points at) {
  double largest = 0;
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const double value = at(i);
    at(i) = value + 1;
    const double above = energy(at);
    at(i) = value - 1;
    const double below = energy(at);
    at(i) = value;
    largest = std::max(largest, std::abs(above - below) / 2);
  }
  return largest;
}

TEST(DisplacementSmoother, SolvesForTheMinimumOfTheEnergy) {
  for (const double stiffness : {0.0, 1.0, 40.0}) {
    Energy energy = energy_on(shapes::square_grid(5), stiffness);
    energy.anchors = {{energy.mesh.faces.col(7), Vector3(0.2, 0.3, 0.5), 10}};
    energy.anchor_wished = Vector3(1, 2, 3);
    const DisplacementSmoother smoother(energy.mesh, energy.anchors, stiffness);
    const Points solution = smoother.solve(energy.wished, energy.matched, energy.anchor_wished);
    EXPECT_LT(largest_gradient(energy, solution), 1e-9);
  }
}

TEST(DisplacementSmoother, EqualsTheDenseSolutionOfTheEquation) {
  const Energy energy = energy_on(shapes::icosphere(1), 1);
  const VertexAdjacency adjacency = vertex_adjacency(energy.mesh);
  const Eigen::Index count = energy.mesh.vertices.cols();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (int k = adjacency.start[static_cast<std::size_t>(i)];
         k < adjacency.start[static_cast<std::size_t>(i) + 1]; ++k) {
      matrix(i, i) += 1;
      matrix(i, adjacency.neighbours[static_cast<std::size_t>(k)]) -= 1;
    }
  const Points dense = matrix.fullPivLu().solve(energy.wished.transpose()).transpose();
  const DisplacementSmoother smoother(energy.mesh, {}, 1);
  EXPECT_TRUE(smoother.solve(energy.wished, energy.matched, energy.anchor_wished).isApprox(dense, 1e-12));
}

TEST(DisplacementSmoother, LeavesUnmatchedVerticesToTheirNeighbours) {
  Energy energy = energy_on(shapes::square_grid(6), 3);
  for (std::size_t i = 0; i < energy.matched.size(); i += 2) energy.matched[i] = 0;
  const DisplacementSmoother smoother(energy.mesh, {}, 3);
  const Points solution = smoother.solve(energy.wished, energy.matched, energy.anchor_wished);
  EXPECT_LT(largest_gradient(energy, solution), 1e-4);
}

TEST(DisplacementSmoother, KeepsConstantDisplacements) {
  Energy energy = energy_on(shapes::joined(shapes::icosphere(2), shapes::square_grid(3)), 100);
  energy.wished.colwise() = Vector3(1, -2, 3);
  energy.matched[5] = energy.matched[17] = 0;
  const DisplacementSmoother smoother(energy.mesh, {}, 100);
  EXPECT_LT((smoother.solve(energy.wished, energy.matched, energy.anchor_wished) - energy.wished).norm(),
            1e-4);
}

TEST(DisplacementSmoother, LeavesAPieceWithoutAnyMatchAlone) {
  Energy energy = energy_on(shapes::joined(shapes::square_grid(2), shapes::square_grid(2)), 2);
  for (std::size_t i = 9; i < 18; ++i) energy.matched[i] = 0;
  const DisplacementSmoother smoother(energy.mesh, {}, 2);
  EXPECT_LT(smoother.solve(energy.wished, energy.matched, energy.anchor_wished).rightCols(9).norm(), 1e-12);
}

TEST(DisplacementSmoother, RejectsAStiffnessThatIsNone) {
  EXPECT_THROW(DisplacementSmoother(shapes::triangle(), {}, -1), InvalidInput);
  EXPECT_THROW(DisplacementSmoother(shapes::triangle(), {}, std::nan("")), InvalidInput);
}

// ---- the whole fitting

struct Scene : test::FittingScene {
  SurfaceFit fit(SurfaceFitOptions options = {}) const {
    options.method = SurfaceFitMethod::laplacian;
    return FittingScene::fit(options);
  }
};

TEST(FitSurfaceLaplacian, LeavesAFittedSourceWhereItIs) {
  const TriangleMesh sphere = shapes::icosphere(2);
  const SurfaceFit fit = Scene{sphere, sphere}.fit();
  EXPECT_LT((fit.vertices - sphere.vertices).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(fit.summary.stop_reason, StopReason::converged);
  EXPECT_EQ(fit.summary.unmatched_vertices, 0u);
}

TEST(FitSurfaceLaplacian, BringsATranslatedSphereBack) {
  const TriangleMesh sphere = shapes::icosphere(3);
  Scene scene{sphere, shapes::moved(shapes::icosphere(4), {Matrix3::Identity(), Vector3(0.05, 0.1, -0.02)})};
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
  Scene scene{sphere, shapes::moved(sphere, {1.1 * Matrix3::Identity(), Vector3::Zero()})};
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
  const SurfaceFit fit = Scene{source, bumpy}.fit();
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
  const Scene scene{strip, shorter};
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
  const SurfaceFit fit = Scene{pieces, target}.fit();
  EXPECT_TRUE(fit.vertices.allFinite());
  EXPECT_EQ(fit.vertices.rightCols(1), pieces.vertices.rightCols(1));

  const SurfaceFit single = Scene{shapes::triangle(), shapes::triangle()}.fit();
  EXPECT_TRUE(single.vertices.isApprox(shapes::triangle().vertices));
}

TEST(FitSurfaceLaplacian, SaysWhyItStopped) {
  const TriangleMesh sphere = shapes::icosphere(2);
  Scene scene{sphere, shapes::moved(sphere, {1.2 * Matrix3::Identity(), Vector3::Zero()})};
  SurfaceFitOptions options;
  options.max_iterations = 1;
  const SurfaceFit fit = scene.fit(options);
  EXPECT_EQ(fit.summary.iterations, 1);
  EXPECT_EQ(fit.summary.stop_reason, StopReason::iteration_cap);
  EXPECT_NE(to_string(fit.summary).find("iteration cap"), std::string::npos);
}

TEST(FitSurface, RejectsWhatDoesNotBelongTogether) {
  const TriangleMesh sphere = shapes::icosphere(1);
  Scene scene{sphere, sphere};
  scene.warped = scene.warped.leftCols(5).eval();
  EXPECT_THROW(scene.fit(), InvalidInput);
  scene.warped = sphere.vertices;
  scene.warped(0, 0) = std::nan("");
  EXPECT_THROW(scene.fit(), InvalidInput);
  scene.warped = sphere.vertices;
  scene.anchor_weights = Eigen::VectorXd::Ones(2);
  EXPECT_THROW(scene.fit(), InvalidInput);
  scene.anchor_weights.resize(0);
  SurfaceFitOptions options;
  options.max_iterations = 0;
  EXPECT_THROW(scene.fit(options), InvalidInput);
  options = {};
  options.epsilon = std::nan("");
  EXPECT_THROW(scene.fit(options), InvalidInput);
  scene.target.faces.resize(3, 0);
  EXPECT_THROW(scene.fit(), InvalidInput);
}

TEST(FitSurface, StopsWhenAsked) {
  const TriangleMesh sphere = shapes::icosphere(1);
  const Eigen::VectorXd none(0);
  Progress progress;
  progress.cancelled = [] { return true; };
  EXPECT_THROW(fit_surface({sphere, sphere.vertices, sphere, Points(3, 0), Points(3, 0), none}, {}, progress),
               Interrupted);
}

}  // namespace
}  // namespace bespoke
