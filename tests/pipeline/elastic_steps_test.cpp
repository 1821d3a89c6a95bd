#include "bespoke/pipeline/elastic_steps.h"

#include <gtest/gtest.h>

#include <numbers>

#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/make_map.h"
#include "bespoke/statistics.h"
#include "flow/bent_tube.h"

namespace bespoke {
namespace {

constexpr double degree = std::numbers::pi / 180;

FitOptions options_of(const TriangleMesh& source) {
  FitOptions options = default_options(diagonal(source.vertices)).fit;
  options.fit_tolerance *= 10;
  return options;
}

FittedMapping fit_bent(const TriangleMesh& source, double angle, const FitOptions& options,
                       const Anchors& anchors = {}) {
  return fit_mapping_to_fitted(source, {test::bent(source.vertices, angle), source.faces}, anchors, options);
}

TEST(ElasticSteps, AreOneForOnePose) {
  const TriangleMesh source = test::tube();
  const FittedMapping fit = fit_bent(source, 30 * degree, options_of(source));
  EXPECT_EQ(fit.elastic->steps().size(), 1u);
  EXPECT_FALSE(fit.plan.has_value());
}

TEST(ElasticSteps, MeetTheFittedSourceWhereALimbTurns) {
  const TriangleMesh source = test::tube();
  const FitOptions options = options_of(source);
  const FittedMapping fit = fit_bent(source, 150 * degree, options);
  // No step turns a part by more than 30°.
  const double turn = fit.summary.elastic.motion.turn;
  EXPECT_GT(turn, 60 * degree);
  EXPECT_GE(static_cast<double>(fit.elastic->steps().size()), turn / (30 * degree));
  EXPECT_EQ(fit.step_sources.size(), fit.elastic->steps().size());
  // Each step starts where the ones before have ended, so that the whole misses no more than one step does.
  EXPECT_LE(fit.summary.elastic.vertex_residuals.p95, options.fit_tolerance);
  for (const auto& step : fit.elastic->steps()) {
    const Matrix3 linear = step->affine().linear;
    const double scale = std::cbrt(linear.determinant());
    EXPECT_LT((linear * linear.transpose() - scale * scale * Matrix3::Identity()).norm(), 1e-9)
        << "the affine part of a step is a similarity";
  }
}

TEST(ElasticSteps, FollowTheOptionRatherThanTheTurn) {
  const TriangleMesh source = test::tube();
  FitOptions options = options_of(source);
  options.steps = 3;
  EXPECT_EQ(fit_bent(source, 30 * degree, options).elastic->steps().size(), 3u);
}

TEST(ElasticSteps, CarryAnchorsOffTheSurfaceWithIt) {
  const TriangleMesh source = test::tube();
  const FitOptions options = options_of(source);
  Anchors anchors;
  Points q(3, 6);
  q << 0, 0, 3, 9, 9, 10, 0.5, 0, -0.5, 0.9, 0, 0.5, 0, 0.5, 0, 0, 0.9, 0;
  const Points image = test::bent(q, 120 * degree);
  for (Eigen::Index i = 0; i < q.cols(); ++i)
    anchors.pairs.push_back({"anchor " + std::to_string(i), q.col(i), image.col(i)});
  const FittedMapping fit = fit_bent(source, 120 * degree, options, anchors);
  EXPECT_GT(fit.elastic->steps().size(), 1u);
  EXPECT_GE(fit.summary.elastic.anchors_off_surface, 2u);
  EXPECT_LE(fit.summary.elastic.anchor_residuals.max, 2 * options.fit_tolerance);
}

TEST(ElasticSteps, CanBeDivided) {
  const TriangleMesh source = test::tube();
  FitOptions options = options_of(source);
  options.steps = 3;
  FittedMapping fit = fit_bent(source, 90 * degree, options);
  const std::size_t before = fit.elastic->steps().size();
  const auto maps = fit.elastic->steps();
  const Points next = fit.step_sources[2];
  divide_step(fit, source, {}, options, 1);
  EXPECT_EQ(fit.elastic->steps().size(), before + 1);
  EXPECT_EQ(fit.elastic->steps().front(), maps.front());
  EXPECT_EQ(fit.elastic->steps().back(), maps.back());
  EXPECT_EQ(fit.plan->steps(), before + 1);
  // The second half ends where the whole step did.
  const Points end = (*fit.elastic->steps()[2])(fit.step_sources[2]);
  const Eigen::VectorXd missed = (end - next).colwise().norm();
  EXPECT_LE(summarize({missed.begin(), missed.end()}).p95, options.fit_tolerance);
  EXPECT_LE(fit.summary.elastic.vertex_residuals.p95, options.fit_tolerance);
}

/// Three tubes side by side, the middle one moved along the others by `slide`.
TriangleMesh tubes(double slide) {
  constexpr double between = 0.02;
  const TriangleMesh tube = test::tube();
  const Eigen::Index points = tube.vertices.cols(), faces = tube.faces.cols();
  TriangleMesh three{Points(3, 3 * points), Faces(3, 3 * faces)};
  for (int i = 0; i < 3; ++i) {
    const Vector3 place(i == 1 ? slide : 0, i * (2 * test::tube_radius + between), 0);
    three.vertices.middleCols(i * points, points) = tube.vertices.colwise() + place;
    three.faces.middleCols(i * faces, faces) = tube.faces.array() + static_cast<int>(i * points);
  }
  return three;
}

// Between tubes that slide along each other space is sheared too steeply for the voxels of one step.
TEST(ElasticSteps, TakeThePlaceOfASingleOneThatFoldsWhenItIsBaked) {
  const TriangleMesh source = tubes(0), fitted = tubes(0.08);
  MakeMapOptions options = default_options(diagonal(source.vertices));
  options.bake.max_leaves = 1500;
  options.fit.steps = 1;
  const MadeMap one = make_map({source, fitted, {}, &fitted}, options);
  ASSERT_GT(one.asset.steps.front().certificate.folded, 0u);
  EXPECT_GT(one.fit.summary.bake->folded_cells, 0u);

  options.fit.steps.reset();
  const MadeMap chain = make_map({source, fitted, {}, &fitted}, options);
  EXPECT_GT(chain.asset.steps.size(), 1u);
  std::size_t levels = 0;
  for (const MapStep& step : chain.asset.steps) {
    EXPECT_TRUE(step.certificate.is_bijection());
    levels += step.pyramid.levels.size();
  }
  EXPECT_EQ(chain.fit.summary.elastic.divided_steps, chain.asset.steps.size() - 1);
  EXPECT_LE(chain.fit.summary.elastic.vertex_residuals.max, 2 * options.fit.fit_tolerance);
  // Nothing of the bake that was given up is told.
  EXPECT_EQ(chain.fit.summary.bake->levels.size(), levels);
  EXPECT_EQ(chain.fit.summary.bake->folded_cells, 0u);
}

TEST(ElasticSteps, BecomeMoreWherePartsSlideAlongEachOther) {
  const TriangleMesh source = tubes(0), fitted = tubes(0.6);
  FitOptions options = default_options(diagonal(source.vertices)).fit;
  options.steps = 1;
  const FittedMapping one = fit_mapping_to_fitted(source, fitted, {}, options);
  EXPECT_GT(one.summary.elastic.vertex_residuals.p99, 100 * options.fit_tolerance);
  EXPECT_FALSE(one.summary.elastic.divided_where_missed);

  options.steps.reset();
  const FittedMapping chain = fit_mapping_to_fitted(source, fitted, {}, options);
  EXPECT_GT(chain.elastic->steps().size(), 1u);
  EXPECT_TRUE(chain.summary.elastic.divided_where_missed);
  EXPECT_LE(chain.summary.elastic.vertex_residuals.p99, options.fit_tolerance);
}

}  // namespace
}  // namespace bespoke
