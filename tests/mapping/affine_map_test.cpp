#include "bespoke/mapping/affine_map.h"

#include <gmock/gmock.h>

#include "bespoke/error.h"
#include "support/elastic_map_contract.h"

namespace bespoke {
namespace {

const Vector3 point(0.3, -2, 5);

TEST(AffineMap, ComposesInTheOrderOfApplication) {
  const AffineMap outer = test::some_affine(), inner = as_affine(test::some_rigid());
  EXPECT_LT((compose(outer, inner) * point - outer * (inner * point)).norm(), 1e-14);
}

TEST(AffineMap, InverseUndoesIt) {
  const AffineMap map = test::some_affine();
  EXPECT_LT((inverse(map) * (map * point) - point).norm(), 1e-14);
  EXPECT_LT((map * (inverse(map) * point) - point).norm(), 1e-14);
}

TEST(AffineMap, RefusesToInvertASingularMap) {
  AffineMap flat;
  flat.linear.col(2) = flat.linear.col(1);
  EXPECT_THROW(inverse(flat), InvalidInput);
}

}  // namespace
}  // namespace bespoke
