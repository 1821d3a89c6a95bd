#include "bespoke/pipeline/hopeless_fit.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/analytic_map.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

/// A fit whose map is so many times the same affine one.
FittedMapping chain_of(const AffineMap& map, std::size_t steps, const TriangleMesh& source) {
  FittedMapping fit;
  fit.elastic = std::make_shared<const ElasticChain>(std::vector<std::shared_ptr<const ElasticMap>>(
      steps, std::make_shared<const AnalyticMap>(std::vector<Bump>{}, map)));
  fit.fitted_vertices = (*fit.elastic)(source.vertices);
  return fit;
}

TEST(HopelessFit, IsOneOfManyStepsOrOfVolumesThatVanish) {
  const TriangleMesh ball = shapes::icosphere(2);
  const AffineMap larger{1.1 * Matrix3::Identity(), Vector3::Zero()};
  const AffineMap flatter{Matrix3(Vector3(1, 1, 1e-3).asDiagonal()), Vector3::Zero()};
  EXPECT_NO_THROW(require_hopeful(chain_of(larger, 10, ball), ball, {}));
  EXPECT_NEAR(map_health(chain_of(larger, 10, ball), ball).low, 1, 1e-9);
  EXPECT_THROW(require_hopeful(chain_of(larger, 25, ball), ball, {}), SolverError);
  EXPECT_NO_THROW(require_hopeful(chain_of(flatter, 1, ball), ball, {}));
  EXPECT_THROW(require_hopeful(chain_of(flatter, 4, ball), ball, {}), SolverError);
}

TEST(HopelessFit, IsNoneWhereStepsWereGivenOrMapsFoldByNature) {
  const TriangleMesh ball = shapes::icosphere(2);
  const AffineMap flatter{Matrix3(Vector3(1, 1, 1e-3).asDiagonal()), Vector3::Zero()};
  FitOptions options;
  options.steps = 30;
  EXPECT_NO_THROW(require_hopeful(chain_of(flatter, 30, ball), ball, options));
  options = {};
  options.elastic = ElasticMethod::pffd;
  EXPECT_NO_THROW(require_hopeful(chain_of(flatter, 4, ball), ball, options));
}

}  // namespace
}  // namespace bespoke
