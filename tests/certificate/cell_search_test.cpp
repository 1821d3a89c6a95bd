#include "bespoke/certificate/detail/cell_search.h"

#include <gmock/gmock.h>

#include "bespoke/bake/bake.h"
#include "support/elastic_map_contract.h"

namespace bespoke {
namespace {

TEST(CellSearch, FindsThePreimageWithoutAStartingValue) {
  const AnalyticMap exact = test::strong_bumps();
  BakeOptions options;
  options.tolerance = 3e-3;
  options.error_points = 20000;
  const BakedMap map(exact.affine(), bake(exact, options).pyramid);
  const CellSearch search(map);
  const Points x = 0.7 * Points::Random(3, 200);
  const Points y = map(x);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const std::optional<Vector3> found = search.find(y.col(i), 1e-9);
    ASSERT_TRUE(found.has_value()) << x.col(i).transpose();
    EXPECT_LT((*found - x.col(i)).norm(), 1e-6);
  }
  EXPECT_FALSE(search.find(Vector3(100, 0, 0), 1e-9).has_value());
}

}  // namespace
}  // namespace bespoke
