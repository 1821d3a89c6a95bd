#include "bespoke/pipeline/detail/unusable_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/analytic_map.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

/// So many times the same affine map.
ElasticChain chain_of(const AffineMap& map, std::size_t steps) {
  return ElasticChain(std::vector<std::shared_ptr<const ElasticMap>>(
      steps, std::make_shared<const AnalyticMap>(std::vector<Bump>{}, map)));
}

/// Of a fit whose map is that.
void require_usable_chain(const AffineMap& map, std::size_t steps, const TriangleMesh& source,
                          const FitOptions& options = {}) {
  const ElasticChain chain = chain_of(map, steps);
  require_usable(chain, source, chain(source.vertices), options);
}

TEST(UnusableFit, IsOneOfManyStepsOrOfVolumesThatVanish) {
  const TriangleMesh ball = shapes::icosphere(2);
  const AffineMap larger{1.1 * Matrix3::Identity(), Vector3::Zero()};
  const AffineMap flatter{Matrix3(Vector3(1, 1, 1e-3).asDiagonal()), Vector3::Zero()};
  EXPECT_NO_THROW(require_usable_chain(larger, 10, ball));
  const ElasticChain chain = chain_of(larger, 10);
  EXPECT_NEAR(map_health(chain, ball, chain(ball.vertices)).low, 1, 1e-9);
  EXPECT_THROW(require_usable_chain(larger, 25, ball), SolverError);
  EXPECT_NO_THROW(require_usable_chain(flatter, 1, ball));
  EXPECT_THROW(require_usable_chain(flatter, 4, ball), SolverError);
}

TEST(UnusableFit, IsKnownByItsStepsBeforeTheyAreFitted) {
  EXPECT_NO_THROW(require_useful_steps(max_useful_steps, {}));
  EXPECT_THAT(test::error_message<SolverError>([] { require_useful_steps(max_useful_steps + 1, {}); }),
              ::testing::HasSubstr("25 steps would be needed; are the anchors right"));
  FitOptions options;
  options.steps = 30;
  EXPECT_NO_THROW(require_useful_steps(30, options));
}

TEST(UnusableFit, IsKnownByItsSurfaceBeforeAMapIsFitted) {
  const TriangleMesh ball = shapes::icosphere(3);
  const auto moved = [&](const Matrix3& linear) -> Points { return linear * ball.vertices; };
  EXPECT_NEAR(surface_shear(ball, 5 * ball.vertices), 1, 1e-6);
  // A long ellipsoid is what the nearest affine map makes of a ball.
  EXPECT_NEAR(surface_shear(ball, moved(Vector3(1, 1, 30).asDiagonal())), 1, 1e-6);
  EXPECT_NO_THROW(require_usable_surface(ball, moved(Vector3(1, 1, 30).asDiagonal()), {}));
  // Pleated: every other vertex stays behind.
  Points pleated = ball.vertices;
  for (Eigen::Index i = 0; i < pleated.cols(); i += 2) pleated.col(i) *= 0.05;
  EXPECT_GT(surface_shear(ball, pleated), 10);
  EXPECT_THAT(test::error_message<SolverError>([&] { require_usable_surface(ball, pleated, {}); }),
              ::testing::HasSubstr("more than --max-stretch 10; are the anchors right"));
  FitOptions options;
  options.surface_fit.max_stretch = 1e6;
  EXPECT_NO_THROW(require_usable_surface(ball, pleated, options));
  options = {};
  options.steps = 2;
  EXPECT_NO_THROW(require_usable_surface(ball, pleated, options));
}

TEST(UnusableFit, IsNoneWhereStepsWereGivenOrMapsFoldByNature) {
  const TriangleMesh ball = shapes::icosphere(2);
  const AffineMap flatter{Matrix3(Vector3(1, 1, 1e-3).asDiagonal()), Vector3::Zero()};
  FitOptions options;
  options.steps = 30;
  EXPECT_NO_THROW(require_usable_chain(flatter, 30, ball, options));
  options = {};
  options.elastic = ElasticMethod::pffd;
  EXPECT_NO_THROW(require_usable_chain(flatter, 4, ball, options));
}

TEST(UnusableFit, MissesHalfOfItsAnchorsByMoreThanATenthOfTheirSpan) {
  Anchors anchors;
  for (int k = 0; k < 6; ++k)
    anchors.pairs.push_back({"p" + std::to_string(k), Vector3::Zero(), Vector3(k, 0, 0)});  // 5 long
  const double far = 0.51, near = 0.49;
  EXPECT_NO_THROW(require_met_anchors(anchors, {far, far, near, near, near, near}, {}));
  EXPECT_THAT(test::error_message<SolverError>([&] {
                require_met_anchors(anchors, {far, far, far, near, near, near}, {});
              }),
              ::testing::HasSubstr("half of the anchors are missed by 0.51 or more"));
  FitOptions of_one_step;
  of_one_step.steps = 1;
  EXPECT_NO_THROW(require_met_anchors(anchors, {far, far, far, far, far, far}, of_one_step));
  // Those that may be missed do not count.
  anchors.pairs[0].sigma = 1;
  anchors.pairs[1].weight = 2;
  EXPECT_NO_THROW(require_met_anchors(anchors, {far, far, near, near, near, far}, {}));
  anchors.pairs[2].sigma = 0;
  anchors.pairs[3].sigma = 1;
  EXPECT_NO_THROW(require_met_anchors(anchors, {far, far, far, far, far, far}, {}));
}

}  // namespace
}  // namespace bespoke
