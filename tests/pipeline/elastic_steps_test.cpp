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
