#include "bespoke/pipeline/detail/bake_steps.h"

#include <gtest/gtest.h>

#include "support/analytic_map.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

ElasticChain chain(int steps) {
  std::vector<std::shared_ptr<const ElasticMap>> maps;
  for (int k = 0; k < steps; ++k)
    maps.push_back(std::make_shared<const AnalyticMap>(
        std::vector<Bump>{{Vector3(0.1 * k, 0, 0), 1.0, Vector3(0.1, 0.05, -0.08)}}));
  return ElasticChain(std::move(maps));
}

struct BakeScene {
  TriangleMesh source = shapes::icosphere(3);
  BakeOptions options;
  BakeScene() {
    source.vertices *= 0.6;
    options.tolerance = 1e-3;
    options.error_points = 20'000;
  }
  std::vector<Points> surfaces(const ElasticChain& exact) const {
    std::vector<Points> surfaces{source.vertices};
    for (std::size_t k = 0; k + 1 < exact.steps().size(); ++k)
      surfaces.push_back((*exact.steps()[k])(surfaces.back()));
    return surfaces;
  }
};

TEST(BakeSteps, MeetTheToleranceAsAWhole) {
  const BakeScene scene;
  const ElasticChain exact = chain(4);
  const BakedSteps baked = bake_steps({exact, scene.surfaces(exact), scene.source.faces}, scene.options);
  ASSERT_EQ(baked.steps.size(), 4u);
  EXPECT_TRUE(baked.whole.tolerance_met);
  // At points that no measure has used.
  const Points x = test::random_points(20'000, 3);
  const Points error = baked_chain(baked.steps)(x) - exact(x);
  EXPECT_LE(error.colwise().norm().maxCoeff(), 1.1 * scene.options.tolerance);
  for (const MapStep& step : baked.steps) EXPECT_TRUE(step.certificate.is_bijection());
}

TEST(BakeSteps, SayWhereTheWholeWasMeasured) {
  const BakeScene scene;
  for (const int steps : {1, 3}) {
    const ElasticChain exact = chain(steps);
    const BakeSummary whole =
        bake_steps({exact, scene.surfaces(exact), scene.source.faces}, scene.options).whole;
    EXPECT_GE(whole.error_random_points, scene.options.error_points) << steps;
    EXPECT_GT(whole.error_surface_points, 0u) << steps;
    EXPECT_EQ(whole.error_random_points + whole.error_surface_points, whole.error.count) << steps;
  }
}

TEST(BakeSteps, OfOneStepAreItsBake) {
  const BakeScene scene;
  const ElasticChain exact = chain(1);
  const BakedSteps baked = bake_steps({exact, scene.surfaces(exact), scene.source.faces}, scene.options);
  BakeOptions options = scene.options;
  options.surface = &scene.source;
  const Bake expected = bake(*exact.steps().front(), options);
  ASSERT_EQ(baked.steps.size(), 1u);
  ASSERT_EQ(baked.steps[0].pyramid.levels.size(), expected.pyramid.levels.size());
  for (std::size_t level = 0; level < expected.pyramid.levels.size(); ++level) {
    EXPECT_EQ(baked.steps[0].pyramid.levels[level].leaves, expected.pyramid.levels[level].leaves);
    EXPECT_EQ(baked.steps[0].pyramid.levels[level].values, expected.pyramid.levels[level].values);
  }
  EXPECT_EQ(baked.whole.error.max, expected.summary.error.max);
}

TEST(BakeSteps, EndAtAStepThatFoldsAndMayBeDividedAndGoOnFromThoseAfterIt) {
  const BakeScene scene;
  const std::vector<std::shared_ptr<const ElasticMap>> sound = chain(3).steps();
  // A bump that moves points farther than it is wide takes space back over itself.
  const auto folding =
      std::make_shared<const AnalyticMap>(std::vector<Bump>{{Vector3(0.1, 0, 0), 0.3, Vector3(0.6, 0, 0)}});
  const ElasticChain folded({sound[0], folding, sound[2]});
  const std::vector<bool> divisible(3, true);
  BakeOptions options = scene.options;
  options.tolerance = 0.02;
  BakedSteps last =
      bake_steps({folded, scene.surfaces(folded), scene.source.faces}, options, {divisible, {}});
  ASSERT_EQ(last.steps.size(), 2u);
  EXPECT_TRUE(is_to_be_divided(last, divisible));
  last.steps.erase(last.steps.begin());
  last.summaries.erase(last.summaries.begin());
  EXPECT_FALSE(is_to_be_divided(last, divisible));

  const auto values = last.steps.front().pyramid.levels.front().values;
  const ElasticChain exact(sound);
  const BakedSteps baked =
      bake_steps({exact, scene.surfaces(exact), scene.source.faces}, options, {divisible, std::move(last)});
  ASSERT_EQ(baked.steps.size(), 3u);
  EXPECT_EQ(baked.steps.back().pyramid.levels.front().values, values);
}

// A step that is divided when those after it are baked would else leave little for its parts.
TEST(BakeSteps, ShareFewLeavesEvenlyHoweverLateTheyWereDivided) {
  BakeScene scene;
  scene.options.tolerance = 1e-5;
  scene.options.max_leaves = 800;
  const ElasticChain exact = chain(4);
  const std::vector<Points> surfaces = scene.surfaces(exact);
  const ElasticChain second_half({exact.steps()[2], exact.steps()[3]});
  BakedSteps last = bake_steps({second_half, {surfaces[2], surfaces[3]}, scene.source.faces}, scene.options);
  ASSERT_GT(last.steps[0].pyramid.leaf_count() + last.steps[1].pyramid.leaf_count(), 700u);
  const BakedSteps baked = bake_steps({exact, surfaces, scene.source.faces}, scene.options,
                                      {std::vector<bool>(4, true), std::move(last)});
  ASSERT_EQ(baked.steps.size(), 4u);
  for (const MapStep& step : baked.steps) {
    EXPECT_NEAR(static_cast<double>(step.pyramid.leaf_count()), 200, 40);
    EXPECT_TRUE(step.certificate.is_bijection());
  }
}

}  // namespace
}  // namespace bespoke
