#include "bespoke/surface_fit/detail/deformation_graph_fit.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <limits>

#include "bespoke/error.h"
#include "bespoke/rigid/rigid_alignment.h"
#include "bespoke/surface_fit/graph/deformation_nodes.h"
#include "support/arithmetic.h"
#include "support/bent_tube.h"
#include "support/fitting_scene.h"
#include "support/potato.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using shapes::bend;
using shapes::potato;

using test::infinity;

using Scene = test::FittingScene;

/// A vertex that lands farther off than this has passed a neighbour's place.
double mean_edge_length(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& face : mesh.faces.colwise())
    for (int k = 0; k < 3; ++k)
      sum += (mesh.vertices.col(face((k + 1) % 3)) - mesh.vertices.col(face(k))).norm();
  return sum / static_cast<double>(mesh.faces.size());
}

/// A featured closed surface and its smooth image with finer connectivity, twelve exact anchors.
Scene bent_scene() {
  Scene scene{potato(4), potato(5)};
  for (auto&& x : scene.target.vertices.colwise()) x = bend(x);
  scene.anchor_sources = scene.source.vertices.leftCols(12);
  scene.anchor_targets.resize(3, 12);
  for (int k = 0; k < 12; ++k) scene.anchor_targets.col(k) = bend(scene.anchor_sources.col(k));
  scene.anchor_weights = Eigen::VectorXd::Constant(12, infinity);
  return scene;
}

/// An upright ellipsoid like a finger.
TriangleMesh finger(double x) {
  return shapes::moved(shapes::icosphere(3), {Vector3(0.06, 1, 0.06).asDiagonal(), Vector3(x, 0, 0)});
}

TEST(FitSurfaceDeformationGraph, LeavesAFingerThatTheTargetLacksBesideItsNeighbour) {
  const double apart = 0.15;
  Scene scene{shapes::joined(finger(0), finger(apart)), finger(0)};
  for (auto&& x : scene.target.vertices.colwise()) x[2] += 0.02 * x[1] * x[1];
  const Eigen::Index half = scene.target.vertices.cols();
  scene.anchor_sources = scene.source.vertices.leftCols(12);
  scene.anchor_targets = scene.target.vertices.leftCols(12);
  scene.anchor_weights = Eigen::VectorXd::Constant(12, infinity);
  const SurfaceFit fit = scene.fit();
  const Points moved = fit.vertices - scene.source.vertices;
  EXPECT_LT(moved.rightCols(half).topRows(1).cwiseAbs().maxCoeff(), 0.1 * apart);
  EXPECT_LT((fit.vertices.leftCols(half) - scene.target.vertices).colwise().norm().mean(), 0.01);
}

TEST(FitSurfaceDeformationGraph, IsTheDefault) {
  EXPECT_EQ(SurfaceFitOptions{}.method, SurfaceFitMethod::deformation_graph);
}

TEST(FitSurfaceDeformationGraph, RecoversASimilarity) {
  const AffineMap truth{1.1 * Eigen::AngleAxisd(0.06, Vector3(1, 2, 2) / 3).toRotationMatrix(),
                        Vector3(0.02, 0.01, -0.03)};
  // The finer copy's own vertices lie on the potato, not on the coarser facets: compare the same surface.
  Scene scene{potato(4), shapes::moved(potato(4), truth)};
  const SurfaceFit fit = scene.fit();
  EXPECT_TRUE(fit.summary.similarity_suffices);
  EXPECT_LT((fit.vertices - truth * scene.source.vertices).colwise().norm().maxCoeff(),
            1e-9 * diagonal(scene.source.vertices));
}

TEST(FitSurfaceDeformationGraph, TakesTheSimilarityOfANoisyCopyFromExactAnchors) {
  const AffineMap truth{1.1 * Eigen::AngleAxisd(0.06, Vector3(1, 2, 2) / 3).toRotationMatrix(),
                        Vector3(0.02, 0.01, -0.03)};
  Scene scene{potato(4), shapes::moved(potato(4), truth)};
  scene.target.vertices += 2e-3 * test::random_points(scene.target.vertices.cols(), 7);
  const auto off = [&](Eigen::Index anchors) {
    scene.anchor_sources = scene.source.vertices.leftCols(anchors);
    scene.anchor_targets = truth * scene.anchor_sources;
    scene.anchor_weights = Eigen::VectorXd::Constant(anchors, infinity);
    const SurfaceFit fit = scene.fit();
    EXPECT_TRUE(fit.summary.similarity_suffices);
    return (fit.vertices - truth * scene.source.vertices).colwise().norm().maxCoeff();
  };
  EXPECT_LT(off(6), 1e-9);
  EXPECT_LT(off(0), 2e-3);
}

TEST(FitSurfaceDeformationGraph, FollowsASmoothBendWithoutFlipsAndMeetsExactAnchors) {
  const Scene scene = bent_scene();
  const SurfaceFit fit = scene.fit();
  EXPECT_FALSE(fit.summary.similarity_suffices);
  Points truth = scene.source.vertices;
  for (auto&& x : truth.colwise()) x = bend(x);
  const double edge = mean_edge_length(scene.source);
  EXPECT_LT((fit.vertices - truth).colwise().norm().mean(), edge / 2);
  EXPECT_LT((fit.vertices - truth).colwise().norm().maxCoeff(), edge);
  const Points found = face_normals({fit.vertices, scene.source.faces});
  const Points expected = face_normals({truth, scene.source.faces});
  EXPECT_GT(found.cwiseProduct(expected).colwise().sum().minCoeff(), 0);
  EXPECT_LT((fit.vertices.leftCols(12) - scene.anchor_targets).colwise().norm().maxCoeff(),
            1e-9 * diagonal(scene.source.vertices));
  EXPECT_LE(fit.summary.after.p95, 0.0002 * diagonal(scene.source.vertices));
  EXPECT_EQ(fit.summary.unmatched_vertices, 0u);
  for (const double confidence : fit.confidence) EXPECT_GT(confidence, 0.5);
}

/// Of a tube and the same with a bend, its thickness growing along it.
SurfaceFitSummary fit_bent_tube(double degrees, double growth) {
  Scene scene{shapes::tube(), shapes::tube()};
  scene.anchor_sources = scene.source.vertices(Eigen::all, shapes::tube_marks());
  scene.anchor_targets = scene.anchor_sources;
  scene.anchor_weights = Eigen::VectorXd::Constant(scene.anchor_sources.cols(), infinity);
  for (Points* points : {&scene.target.vertices, &scene.anchor_targets})
    for (auto&& x : points->colwise()) {
      x.tail<2>() *= 1 + growth * x[0];
      x = shapes::bent(x, degrees);
    }
  const RigidTransform back =
      align_rigidly(scene.anchor_targets, scene.anchor_sources, scene.anchor_weights.cwiseMin(1));
  scene.target.vertices = back * scene.target.vertices;
  scene.anchor_targets = back * scene.anchor_targets;
  return scene.fit().summary;
}

TEST(FitSurfaceDeformationGraph, ALimbThatKeepsItsShapeGoesWhereItsAnchorsBendIt) {
  const SurfaceFitSummary same = fit_bent_tube(35, 0);
  EXPECT_TRUE(same.posed_by_anchors);
  EXPECT_GT(same.rigidity, 1);
  const SurfaceFitSummary other = fit_bent_tube(35, 0.2);
  EXPECT_FALSE(other.posed_by_anchors);
  EXPECT_EQ(other.rigidity, 1);
}

TEST(FitSurfaceDeformationGraph, ALimbBeyondTheReachOfClosestPointsGoesWhereItsAnchorsBendIt) {
  const SurfaceFitSummary far = fit_bent_tube(70, 0.2);
  EXPECT_TRUE(far.posed_by_anchors);
  EXPECT_EQ(far.rigidity, 1);
  EXPECT_TRUE(fit_bent_tube(150, 1).posed_by_anchors) << "however much the limb is stretched as well";
}

TEST(FitSurfaceDeformationGraph, AccuraciesOfZeroChangeNoBit) {
  Scene scene = bent_scene();
  const Points without = scene.fit().vertices;
  scene.anchor_sigmas = Eigen::VectorXd::Zero(12);
  EXPECT_EQ(scene.fit().vertices, without);
  scene.anchor_sigmas[3] = -1;
  EXPECT_THROW(scene.fit(), InvalidInput);
}

TEST(FitSurfaceDeformationGraph, InaccurateAnchorsHarmLessWithTheirAccuracyAndDoNotFlip) {
  Scene scene = bent_scene();
  Points truth = scene.source.vertices;
  for (auto&& x : truth.colwise()) x = bend(x);
  const auto mean_error = [&](const SurfaceFit& fit) {
    return (fit.vertices - truth).colwise().norm().mean();
  };
  const double sigma = 0.01 * diagonal(scene.source.vertices);
  scene.anchor_targets += std::sqrt(3) * sigma * test::random_points(12, 11);  // deviation sigma
  const double dented = mean_error(scene.fit());
  scene.anchor_sigmas = Eigen::VectorXd::Constant(12, sigma);
  const SurfaceFit fit = scene.fit();
  EXPECT_LT(mean_error(fit), dented);
  const Points found = face_normals({fit.vertices, scene.source.faces});
  const Points expected = face_normals({truth, scene.source.faces});
  EXPECT_GT(found.cwiseProduct(expected).colwise().sum().minCoeff(), 0);
}

/// What of the mesh lies above the height, with all its vertices.
TriangleMesh cut_at(TriangleMesh mesh, double height) {
  std::vector<int> kept;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f)
    if (mesh.vertices(2, mesh.faces.col(f)).minCoeff() > height) kept.push_back(static_cast<int>(f));
  return {mesh.vertices, mesh.faces(Eigen::all, kept)};
}

TEST(FitSurfaceDeformationGraph, ASourceCutFartherOutMeetsTheTargetsCutOnlyWhenRuledSo) {
  // The source goes on below the height at which the target ends.
  constexpr double source_end = -0.5, target_end = -0.35;
  Scene scene{cut_at(potato(4), source_end), cut_at(potato(5), target_end)};
  for (auto&& x : scene.target.vertices.colwise()) x = bend(x);
  std::vector<int> upper;
  for (int i = 0; i < 42; ++i)
    if (scene.source.vertices(2, i) > 0.1) upper.push_back(i);
  scene.anchor_sources = scene.source.vertices(Eigen::all, upper);
  scene.anchor_targets = scene.anchor_sources;
  for (auto&& x : scene.anchor_targets.colwise()) x = bend(x);
  scene.anchor_weights = Eigen::VectorXd::Constant(scene.anchor_sources.cols(), infinity);

  const auto lowest = [&](BoundaryRule rule) {
    SurfaceFitOptions options;
    options.boundaries = rule;
    const SurfaceFit fit = scene.fit(options);
    EXPECT_EQ(fit.summary.matched_boundaries, rule == BoundaryRule::free ? 0 : 1);
    return fit.vertices(2, scene.source.faces.reshaped()).minCoeff();
  };
  // bend() scales heights. Nearer to the one cut than to the other:
  const double source_rim = 0.95 * source_end, target_rim = 0.95 * target_end;
  const double near = std::abs(source_rim - target_rim) / 2;
  EXPECT_NEAR(lowest(BoundaryRule::free), source_rim, near);
  EXPECT_NEAR(lowest(BoundaryRule::matched), target_rim, near);
  // Cuts this near each other are taken for the same.
  EXPECT_NEAR(lowest(BoundaryRule::automatic), target_rim, near);
}

TEST(FitSurfaceDeformationGraph, TheEndOfTheTargetDoesNotAttract) {
  // Half of the potato has no counterpart; it follows the other half instead of crowding at the cut.
  constexpr double cut = 0.4;
  Scene scene = bent_scene();
  std::vector<int> kept;
  for (Eigen::Index f = 0; f < scene.target.faces.cols(); ++f)
    if (scene.target.vertices(0, scene.target.faces(0, f)) < cut) kept.push_back(static_cast<int>(f));
  const Faces faces = scene.target.faces(Eigen::all, kept);
  scene.target.faces = faces;
  const SurfaceFit fit = scene.fit();
  EXPECT_EQ(fit.summary.matched_boundaries, 0);
  double true_reach = 0, beyond = 0, covered = 0;
  for (Eigen::Index i = 0; i < scene.source.vertices.cols(); ++i) {
    const Vector3 truth = bend(scene.source.vertices.col(i));
    const double error = (fit.vertices.col(i) - truth).norm();
    true_reach = std::max(true_reach, truth[0]);
    if (truth[0] > 0.5) beyond = std::max(beyond, error);
    if (truth[0] < 0.3) covered = std::max(covered, error);
    if (truth[0] > 0.6) {
      EXPECT_EQ(fit.confidence[static_cast<std::size_t>(i)], 0);
    }
  }
  EXPECT_LT(covered, mean_edge_length(scene.source));
  // The farthest vertex lies nearer to where it belongs than to the cut.
  EXPECT_LT(beyond, (true_reach - cut) / 2);
}

TEST(FitSurfaceDeformationGraph, GivesTheSameBytesAtAnyThreadCount) {
  const Scene scene = bent_scene();
  Points first;
  for (const std::size_t threads : {1, 2, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const SurfaceFit fit = scene.fit();
    if (first.cols() == 0) first = fit.vertices;
    EXPECT_EQ(fit.vertices, first);
  }
}

/// Eight pairs at the corners of a box around the scene, far off the surface, with targets of their own.
void add_corners(Scene& scene, double half_edge, const Vector3& shift) {
  const Eigen::Index count = scene.anchor_sources.cols();
  scene.anchor_sources.conservativeResize(3, count + 8);
  scene.anchor_targets.conservativeResize(3, count + 8);
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 at = half_edge * Vector3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    scene.anchor_sources.col(count + corner) = at;
    scene.anchor_targets.col(count + corner) = at + shift;
  }
  scene.anchor_weights = Eigen::VectorXd::Constant(count + 8, infinity);
}

TEST(FitSurfaceDeformationGraph, AnchorsFarOffTheSurfaceDoNotDragIt) {
  Scene scene = bent_scene();
  const SurfaceFit without = scene.fit();
  EXPECT_EQ(without.summary.off_surface_anchors, 0u);
  add_corners(scene, 2, Vector3(0.5, -0.3, 0.4));
  const SurfaceFit with = scene.fit();
  EXPECT_EQ(with.summary.off_surface_anchors, 8u);
  EXPECT_EQ(with.vertices, without.vertices);  // the warp, which knows them, is an input and is the same
}

TEST(FitSurfaceDeformationGraph, AnchorsWithinANodeSpacingMoveTheirFoot) {
  Scene scene = bent_scene();
  const double spacing =
      node_spacing(vertex_areas(scene.source).sum(), NodeFitSettings{}.levels.back().nodes);
  const Points normals = vertex_normals(scene.source);
  for (const double height : {0.9, 1.1}) {
    Points lifted = scene.anchor_sources;
    for (int k = 0; k < 12; ++k) lifted.col(k) += height * spacing * normals.col(k);
    EXPECT_EQ(anchors_near(scene.source, lifted).size(), height < 1 ? 12u : 0u);
  }
  // Lifted a little on both sides, an anchor says what it said on the surface.
  for (int k = 0; k < 12; ++k) {
    scene.anchor_sources.col(k) += 0.1 * spacing * normals.col(k);
    scene.anchor_targets.col(k) += 0.1 * spacing * normals.col(k);
  }
  const SurfaceFit fit = scene.fit();
  EXPECT_EQ(fit.summary.off_surface_anchors, 0u);
  for (int k = 0; k < 12; ++k)
    EXPECT_LT((fit.vertices.col(k) - bend(scene.source.vertices.col(k))).norm(), 0.1 * spacing);
}

TEST(FitSurfaceDeformationGraph, FitsWhenAllAnchorsLieOffTheSurface) {
  Scene scene = bent_scene();
  Scene uncovered{scene.source, scene.target};
  Scene cornered = uncovered;
  add_corners(cornered, 2, Vector3::Zero());
  EXPECT_EQ(cornered.fit().vertices, uncovered.fit().vertices);
}

TEST(FitSurfaceDeformationGraph, WorksOnPiecesSingleTrianglesAndLooseVertices) {
  TriangleMesh pieces = shapes::joined(
      potato(3), shapes::moved(shapes::icosphere(1), {0.1 * Matrix3::Identity(), Vector3(2, 0, 0)}));
  pieces.vertices.conservativeResize(3, pieces.vertices.cols() + 1);
  pieces.vertices.rightCols(1) = Vector3(1, 1, 1);
  TriangleMesh target = pieces;
  for (auto&& x : target.vertices.colwise()) x = bend(x);
  const SurfaceFit fit = Scene{pieces, target}.fit();
  EXPECT_TRUE(fit.vertices.allFinite());
  EXPECT_LT((fit.vertices - target.vertices).colwise().norm().maxCoeff(), mean_edge_length(pieces));

  const SurfaceFit single = Scene{shapes::triangle(), shapes::triangle()}.fit();
  EXPECT_TRUE(single.vertices.isApprox(shapes::triangle().vertices, 1e-6));
}

TEST(FitSurfaceDeformationGraph, RejectsWhatItCannotFit) {
  Scene scene = bent_scene();
  scene.warped(0, 0) = std::nan("");
  EXPECT_THROW(scene.fit(), InvalidInput);
  scene = bent_scene();
  scene.target.faces.resize(3, 0);
  EXPECT_THROW(scene.fit(), InvalidInput);
  TriangleMesh flat = shapes::triangle();
  flat.vertices.col(2) = 2 * flat.vertices.col(1);
  EXPECT_THROW((Scene{flat, shapes::triangle()}.fit()), InvalidInput);
  scene = bent_scene();
  scene.warped.setZero();
  EXPECT_THROW(scene.fit(), InvalidInput);
}

TEST(FitSurfaceDeformationGraph, StopsWhenAsked) {
  const Scene scene = bent_scene();
  Progress progress;
  progress.cancelled = [] { return true; };
  EXPECT_THROW(fit_surface({scene.source, scene.warped, scene.target, scene.anchor_sources,
                            scene.anchor_targets, scene.anchor_weights},
                           {}, progress),
               Interrupted);
}

}  // namespace
}  // namespace bespoke
