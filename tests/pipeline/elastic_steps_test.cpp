#include "bespoke/pipeline/elastic_steps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>

#include "bespoke/anchors/anchors.h"
#include "bespoke/error.h"
#include "bespoke/pipeline/detail/divided_map.h"
#include "bespoke/pipeline/detail/fit_map.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/make_map.h"
#include "bespoke/product/mesh_io.h"
#include "bespoke/registration/elastic_pairs.h"
#include "bespoke/rigid/affine_alignment.h"
#include "bespoke/statistics.h"
#include "flow/bent_tube.h"
#include "support/arithmetic.h"
#include "support/error_message.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::degree;
using testing::HasSubstr;

/// Of the layers, which are baked and come apart.
MakeMapOptions layered_options(const TriangleMesh& source) {
  MakeMapOptions options = default_options(diagonal(source.vertices));
  options.fit.elastic = ElasticMethod::diffeomorphic;
  return options;
}

FitOptions options_of(const TriangleMesh& source, ElasticMethod method = ElasticMethod::diffeomorphic) {
  FitOptions options = default_options(diagonal(source.vertices)).fit;
  options.elastic = method;
  options.fit_tolerance *= 10;
  return options;
}

FittedMapping fit_bent(const TriangleMesh& source, double angle, const FitOptions& options,
                       const Anchors& anchors = {}) {
  const TriangleMesh fitted{test::bent(source.vertices, angle), source.faces};
  return fit_mapping({source, fitted, anchors, &fitted}, options);
}

/// The same without Γ, and what it was made of.
struct BentFit {
  BentFit(double angle, const FitOptions& how) : options(how) {
    registration.fitted_vertices = test::bent(source.vertices, angle);
    fit = fit_map(problem(), options);
  }
  MapProblem problem() const { return map_problem(source, registration, options); }
  void divide(std::size_t step, bool leave_path = false) {
    fit = divided_map(fit, {problem(), options, step, leave_path});
  }

  TriangleMesh source = test::tube();
  Registration registration;
  FitOptions options;
  MapFit fit;
};

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

TEST(ElasticSteps, OfFiniteElementsMeetItWithinWhatIsListed) {
  const TriangleMesh source = test::tube();
  const FitOptions options = options_of(source, ElasticMethod::finite_elements);
  const FittedMapping fit = fit_bent(source, 150 * degree, options);
  EXPECT_GE(fit.elastic->steps().size(), 3u);
  EXPECT_LE(fit.summary.elastic.vertex_residuals.p99,
            elastic_method(options.elastic).met_within * options.fit_tolerance);
}

/// A tube bent by 150 degrees in equal steps by finite elements, halved where they are held up or not.
struct FiniteElementSteps {
  FiniteElementSteps(int count, bool halve_blocked)
      : plan(plan_steps(source, fitted, elastic_pairs(source, fitted), count)) {
    const FitOptions options = options_of(source, ElasticMethod::finite_elements);
    ElasticOptions elastic;
    elastic.lambda = options.lambda;
    elastic.fit_tolerance = options.fit_tolerance;
    elastic.max_memory = options.max_memory;
    elastic.max_squeeze = options.max_squeeze;
    steps = fit_elastic_steps(source, elastic_pairs(source, fitted), plan,
                              {ElasticMethod::finite_elements, elastic, halve_blocked});
  }

  bool any_blocked() const { return std::any_of(steps.found.begin(), steps.found.end(), is_blocked); }

  TriangleMesh source = test::tube();
  Points fitted = test::bent(source.vertices, 150 * degree);
  StepPlan plan;
  ElasticSteps steps;
};

TEST(ElasticSteps, OfFiniteElementsThatAreHeldUpAreHalvedOnce) {
  ASSERT_TRUE(FiniteElementSteps(2, false).any_blocked());
  const FiniteElementSteps halved(2, true);
  const std::vector<double>& times = halved.steps.times;
  ASSERT_EQ(times.size(), halved.steps.maps.size() + 1);
  ASSERT_EQ(halved.steps.sources.size(), halved.steps.maps.size());
  EXPECT_GT(halved.steps.maps.size(), 2u);
  EXPECT_LE(halved.steps.maps.size(), 4u);
  EXPECT_EQ(times.front(), 0);
  EXPECT_EQ(times.back(), 1);
  for (std::size_t k = 0; k + 1 < times.size(); ++k) EXPECT_GE(times[k + 1] - times[k], 0.25);
}

TEST(ElasticSteps, OfFiniteElementsAreAsPlannedWhereNothingHoldsThemUp) {
  const FiniteElementSteps small(12, true);
  ASSERT_FALSE(small.any_blocked());
  EXPECT_EQ(small.steps.times, small.plan.times);
}

TEST(ElasticSteps, OfFiniteElementsAreTwiceAsManyAsTheMotionRequires) {
  const TriangleMesh source = test::tube();
  const FittedMapping layers = fit_bent(source, 150 * degree, options_of(source));
  const FittedMapping elements =
      fit_bent(source, 150 * degree, options_of(source, ElasticMethod::finite_elements));
  ASSERT_TRUE(layers.plan && elements.plan);
  EXPECT_GE(elements.plan->steps(), 2 * layers.plan->steps());
}

/// A box about a centre.
TriangleMesh bar(const Vector3& size, const Vector3& center) {
  AffineMap map;
  map.linear = size.asDiagonal();
  map.offset = center - size / 2;
  return shapes::moved(shapes::cube(), map);
}

// Of a body that bends the least-squares affine map may mirror what every part of it only turns.
TEST(ElasticSteps, DoNotTakeTurnedPartsForAMirrorImage) {
  const TriangleMesh along_y = bar({1, 12, 1}, {-2, 0, 0});
  const TriangleMesh others = shapes::joined(bar({12, 1, 1}, {0, 0, 2}), bar({1, 1, 12}, {2, 0, 0}));
  const TriangleMesh source = shapes::joined(along_y, others);
  Points fitted = source.vertices;
  fitted.block(1, 0, 2, along_y.vertices.cols()) *= -1;  // half a turn
  const ElasticPairs pairs = elastic_pairs(source, fitted);
  ASSERT_LT(align_affinely(pairs.sources, pairs.targets, FlatDirections::of_squared_width_1e_12)
                .linear.determinant(),
            0);
  EXPECT_EQ(plan_steps(source, fitted, pairs, 4).steps(), 4u);

  fitted = source.vertices;
  fitted.row(1) *= -1;
  EXPECT_THAT(test::error_message<InvalidInput>(
                  [&] { plan_steps(source, fitted, elastic_pairs(source, fitted), 4); }),
              HasSubstr("mirror it back first"));
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

TEST(ElasticSteps, ComeApartAsTheyAreWhereHalvesOfThePathWouldMiss) {
  const TriangleMesh source = test::tube();
  FitOptions options = options_of(source);
  options.steps = 3;
  BentFit bent(90 * degree, options);
  const MapFit& fit = bent.fit;
  const auto maps = fit.elastic->steps();
  const Points x = 2 * test::random_points(1000, 3), before = (*fit.elastic)(x);
  const double missed = fit.summary.vertex_residuals.max;
  bent.options.fit_tolerance = fit.summary.vertex_residuals.median / 10;
  bent.divide(1);
  ASSERT_EQ(fit.elastic->steps().size(), maps.size() + 1);
  EXPECT_EQ(fit.elastic->steps().front(), maps.front());
  EXPECT_EQ(fit.elastic->steps().back(), maps.back());
  EXPECT_FALSE(fit.plan.has_value()) << "the chain has left its path";
  EXPECT_LT(test::largest_distance((*fit.elastic)(x), before), 1e-12);
  EXPECT_NEAR(fit.summary.vertex_residuals.max, missed, 1e-12);
  EXPECT_LT(test::largest_distance((*fit.elastic->steps()[1])(fit.step_sources[1]), fit.step_sources[2]),
            1e-12);
}

TEST(ElasticSteps, ComeApartUntilTheyAreSingleLayers) {
  const TriangleMesh source = test::tube();
  BentFit bent(30 * degree, options_of(source));
  const MapFit& fit = bent.fit;
  const Points before = (*fit.elastic)(source.vertices);
  for (std::size_t step = 0; step < fit.elastic->steps().size();)
    is_divisible(fit, step) ? bent.divide(step, true) : static_cast<void>(++step);
  EXPECT_GT(fit.elastic->steps().size(), 2u);
  EXPECT_LT(test::largest_distance((*fit.elastic)(source.vertices), before), 1e-12);
  EXPECT_THAT(test::error_message<InvalidInput>([&] { bent.divide(0); }), HasSubstr("no such step"));
}

TEST(ElasticSteps, AreHalvedAlongThePathWhileTheyMeetTheirVertices) {
  const TriangleMesh source = test::tube();
  for (const ElasticMethod method : {ElasticMethod::diffeomorphic, ElasticMethod::multiscale}) {
    FitOptions options = options_of(source);
    options.elastic = method;
    options.steps = 3;
    BentFit bent(90 * degree, options);
    const MapFit& fit = bent.fit;
    const std::size_t before = fit.elastic->steps().size();
    const auto maps = fit.elastic->steps();
    const Points next = fit.step_sources[2];
    bent.divide(1);
    EXPECT_EQ(fit.elastic->steps().size(), before + 1);
    EXPECT_EQ(fit.elastic->steps().front(), maps.front());
    EXPECT_EQ(fit.elastic->steps().back(), maps.back());
    ASSERT_TRUE(fit.plan.has_value());
    EXPECT_EQ(fit.plan->steps(), before + 1);
    EXPECT_EQ(fit.summary.divided_steps, 1u);
    // The second half ends where the whole step did.
    const Points end = (*fit.elastic->steps()[2])(fit.step_sources[2]);
    const Eigen::VectorXd missed = (end - next).colwise().norm();
    EXPECT_LE(summarize({missed.begin(), missed.end()}).p95, options.fit_tolerance);
    EXPECT_LE(fit.summary.vertex_residuals.p95, options.fit_tolerance);
  }
}

// Five anchors, most at the ends of limbs, leave the rest of a strong pose to the surfaces.
TEST(ElasticStepsSharedCase, FollowAPoseThatFiveAnchorsTell) {
  const std::string folder = std::string(BESPOKE_SHARED_DIR) + "/cases/d08_pose_body/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared cases here";
  const TriangleMesh source = read_triangle_mesh(folder + "reference_a.obj");
  const TriangleMesh target = read_triangle_mesh(folder + "reference_b.obj");
  Anchors anchors = read_anchors(folder + "anchors.json");
  const std::set<std::string> kept{"crown", "bigtoe_tip_l", "middle_tip_l", "middle_tip_r", "sacrum"};
  std::erase_if(anchors.pairs, [&](const AnchorPair& pair) { return !kept.contains(pair.name); });
  ASSERT_EQ(anchors.pairs.size(), kept.size());
  const FitOptions options = layered_options(source).fit;
  const FittedMapping fit = fit_mapping({source, target, anchors}, options);
  EXPECT_TRUE(fit.summary.surface->posed_by_anchors);
  EXPECT_GT(fit.elastic->steps().size(), 1u);
  EXPECT_LE(fit.summary.elastic.vertex_residuals.p95, options.fit_tolerance);
}

/// What is known of E alone.
MapFit map_fit(const FittedMapping& fit) {
  return {fit.elastic, fit.step_sources, fit.plan, fit.summary.elastic};
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
  MakeMapOptions options = layered_options(source);
  options.bake.max_leaves = 1500;
  options.fit.steps = 1;
  const MadeMap one = make_map({source, fitted, {}, &fitted}, options);
  ASSERT_GT(one.asset.steps.front().certificate.folded, 0u);
  EXPECT_GT(one.fit->summary.bake->folded_cells, 0u);

  options.fit.steps.reset();
  const MadeMap chain = make_map({source, fitted, {}, &fitted}, options);
  EXPECT_GT(chain.asset.steps.size(), 1u);
  std::size_t levels = 0;
  for (const MapStep& step : chain.asset.steps) {
    EXPECT_TRUE(step.certificate.is_bijection());
    levels += step.pyramid.levels.size();
  }
  EXPECT_EQ(chain.fit->summary.elastic.divided_steps, chain.asset.steps.size() - 1);
  EXPECT_LE(chain.fit->summary.elastic.vertex_residuals.max, 2 * options.fit.fit_tolerance);
  // Nothing of the bake that was given up is told.
  EXPECT_EQ(chain.fit->summary.bake->levels.size(), levels);
  EXPECT_EQ(chain.fit->summary.bake->folded_cells, 0u);
}

// A composition that goes over its scales again and again is too steep for voxels: to bake it, only to learn
// that it folds, takes longer than all the steps that take its place.
TEST(ElasticSteps, AreDividedBeforeTheyAreBakedWhereTheyAreForeseenToFold) {
  const TriangleMesh source = tubes(0), fitted = tubes(0.16);
  MakeMapOptions options = layered_options(source);
  std::vector<std::string> stages;
  Progress progress;
  progress.report = [&](std::string_view stage, std::size_t, std::size_t) { stages.emplace_back(stage); };
  const auto elastic_until = [&](std::vector<std::string>::const_iterator end) {
    return std::count(stages.cbegin(), end, "elastic");
  };

  const FittedMapping one = fit_mapping({source, fitted, {}, &fitted}, options.fit, progress);
  ASSERT_EQ(one.elastic->steps().size(), 1u);
  EXPECT_TRUE(is_foreseen_to_fold(map_fit(one), 0));
  EXPECT_THROW(is_foreseen_to_fold(map_fit(one), 1), std::out_of_range);
  const TriangleMesh near = tubes(0.02);
  EXPECT_FALSE(is_foreseen_to_fold(map_fit(fit_mapping({source, near, {}, &near}, options.fit)), 0));
  const auto before = elastic_until(stages.cend());

  stages.clear();
  options.bake.max_leaves = 1500;
  const MadeMap made = make_map({source, fitted, {}, &fitted}, options, progress);
  EXPECT_GT(elastic_until(std::find(stages.cbegin(), stages.cend(), "bake")), before);
  for (std::size_t k = 0; k < made.asset.steps.size(); ++k)
    EXPECT_FALSE(is_foreseen_to_fold(map_fit(*made.fit), k)) << k;
}

// Halves of a step share what it had to say, and the voxels that the steps after them have left.
TEST(ElasticSteps, AreEqualAgainWhereManyFoldWhenTheyAreBaked) {
  const TriangleMesh source = tubes(0), fitted = tubes(0.2);
  MakeMapOptions options = layered_options(source);
  options.bake.max_leaves = 2500;
  const MadeMap made = make_map({source, fitted, {}, &fitted}, options);
  ASSERT_EQ(step_count(made.fit->summary.elastic.motion), 1);
  ASSERT_GT(made.fit->summary.elastic.divided_steps, 1u);
  ASSERT_TRUE(made.fit->plan.has_value());
  EXPECT_EQ(made.fit->plan->times, equal_times(static_cast<int>(made.asset.steps.size())));
  EXPECT_LE(made.fit->summary.elastic.vertex_residuals.p95, options.fit.fit_tolerance);
  for (const MapStep& step : made.asset.steps) EXPECT_TRUE(step.certificate.is_bijection());
}

TEST(ElasticSteps, LeaveGuidesThatTakeOneBeyondItsVoxels) {
  const TriangleMesh source = shapes::icosphere(4);
  TriangleMesh fitted = source;
  for (auto x : fitted.vertices.colwise())
    x = Vector3(1.1 * x[0], 0.9 * x[1] + 0.05 * x[0] * x[0], 1.2 * x[2]);
  MakeMapOptions options = layered_options(source);
  const auto make = [&] { return make_map({source, fitted, {}, &fitted}, options); };
  const auto leaves = [](const MadeMap& made) {
    std::size_t sum = 0;
    for (const BakeLevelSummary& level : made.fit->summary.bake->levels) sum += level.leaves;
    return sum;
  };
  const MadeMap guided = make();
  EXPECT_FALSE(guided.fit->summary.elastic.left_guides);
  EXPECT_GT(leaves(guided), 700u);
  EXPECT_THAT(guided.asset.record.options_json, HasSubstr("\"guides\":\"all\""));

  options.bake.max_leaves = 700;
  const MadeMap within = make();
  EXPECT_TRUE(within.fit->summary.elastic.left_guides);
  EXPECT_LE(leaves(within), 700u);
  EXPECT_TRUE(within.fit->summary.bake->relaxed.empty());
  EXPECT_THAT(within.asset.record.options_json, HasSubstr("\"guides\":\"none\""));
}

TEST(ElasticSteps, BecomeMoreWherePartsSlideAlongEachOther) {
  const TriangleMesh source = tubes(0), fitted = tubes(0.6);
  FitOptions options = default_options(diagonal(source.vertices)).fit;
  options.elastic = ElasticMethod::diffeomorphic;
  options.steps = 1;
  const FittedMapping one = fit_mapping({source, fitted, {}, &fitted}, options);
  EXPECT_GT(one.summary.elastic.vertex_residuals.p99, 100 * options.fit_tolerance);
  EXPECT_FALSE(one.summary.elastic.divided_where_missed);

  options.steps.reset();
  const FittedMapping chain = fit_mapping({source, fitted, {}, &fitted}, options);
  EXPECT_GT(chain.elastic->steps().size(), 1u);
  EXPECT_TRUE(chain.summary.elastic.divided_where_missed);
  EXPECT_LE(chain.summary.elastic.vertex_residuals.p99, options.fit_tolerance);
  // Guides beside one tube would have to go with the other too.
  EXPECT_TRUE(chain.summary.elastic.left_guides);
  EXPECT_TRUE(one.summary.elastic.left_guides);
}

}  // namespace
}  // namespace bespoke
