#include "bespoke/pipeline/detail/hopeless_fit.h"

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
void require_hopeful_chain(const AffineMap& map, std::size_t steps, const TriangleMesh& source,
                           const FitOptions& options = {}) {
  const ElasticChain chain = chain_of(map, steps);
  require_hopeful(chain, source, chain(source.vertices), options);
}

TEST(HopelessFit, IsOneOfManyStepsOrOfVolumesThatVanish) {
  const TriangleMesh ball = shapes::icosphere(2);
  const AffineMap larger{1.1 * Matrix3::Identity(), Vector3::Zero()};
  const AffineMap flatter{Matrix3(Vector3(1, 1, 1e-3).asDiagonal()), Vector3::Zero()};
  EXPECT_NO_THROW(require_hopeful_chain(larger, 10, ball));
  const ElasticChain chain = chain_of(larger, 10);
  EXPECT_NEAR(map_health(chain, ball, chain(ball.vertices)).low, 1, 1e-9);
  EXPECT_THROW(require_hopeful_chain(larger, 25, ball), SolverError);
  EXPECT_NO_THROW(require_hopeful_chain(flatter, 1, ball));
  EXPECT_THROW(require_hopeful_chain(flatter, 4, ball), SolverError);
}

TEST(HopelessFit, IsKnownByItsStepsBeforeTheyAreFitted) {
  EXPECT_NO_THROW(require_useful_steps(max_useful_steps, {}));
  EXPECT_THAT(test::error_message<SolverError>([] { require_useful_steps(max_useful_steps + 1, {}); }),
              ::testing::HasSubstr("25 steps would be needed; are the anchors right"));
  FitOptions options;
  options.steps = 30;
  EXPECT_NO_THROW(require_useful_steps(30, options));
}

TEST(HopelessFit, IsKnownByItsSurfaceBeforeAMapIsFitted) {
  const TriangleMesh ball = shapes::icosphere(3);
  const auto moved = [&](const Matrix3& linear) -> Points { return linear * ball.vertices; };
  EXPECT_NEAR(surface_shear(ball, 5 * ball.vertices), 1, 1e-6);
  // A long ellipsoid is what the nearest affine map makes of a ball.
  EXPECT_NEAR(surface_shear(ball, moved(Vector3(1, 1, 30).asDiagonal())), 1, 1e-6);
  EXPECT_NO_THROW(require_hopeful_surface(ball, moved(Vector3(1, 1, 30).asDiagonal()), {}));
  // Crumpled: every other vertex stays behind.
  Points crumpled = ball.vertices;
  for (Eigen::Index i = 0; i < crumpled.cols(); i += 2) crumpled.col(i) *= 0.05;
  EXPECT_GT(surface_shear(ball, crumpled), 10);
  EXPECT_THAT(test::error_message<SolverError>([&] { require_hopeful_surface(ball, crumpled, {}); }),
              ::testing::HasSubstr("more than --max-stretch 10; are the anchors right"));
  FitOptions options;
  options.surface_fit.max_stretch = 1e6;
  EXPECT_NO_THROW(require_hopeful_surface(ball, crumpled, options));
  options = {};
  options.steps = 2;
  EXPECT_NO_THROW(require_hopeful_surface(ball, crumpled, options));
}

TEST(HopelessFit, IsNoneWhereStepsWereGivenOrMapsFoldByNature) {
  const TriangleMesh ball = shapes::icosphere(2);
  const AffineMap flatter{Matrix3(Vector3(1, 1, 1e-3).asDiagonal()), Vector3::Zero()};
  FitOptions options;
  options.steps = 30;
  EXPECT_NO_THROW(require_hopeful_chain(flatter, 30, ball, options));
  options = {};
  options.elastic = ElasticMethod::pffd;
  EXPECT_NO_THROW(require_hopeful_chain(flatter, 4, ball, options));
}

}  // namespace
}  // namespace bespoke
