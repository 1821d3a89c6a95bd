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

}  // namespace
}  // namespace bespoke
