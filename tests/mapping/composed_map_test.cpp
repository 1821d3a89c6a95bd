#include "bespoke/mapping/composed_map.h"

#include <gmock/gmock.h>

#include "bespoke/bake/bake.h"
#include "bespoke/lattice/baked_map.h"
#include "support/elastic_map_contract.h"

namespace bespoke {
namespace {

using namespace test;

TEST(ComposedMap, IsOneMapAfterTheOther) {
  const AnalyticMap first = strong_bumps();
  const AnalyticMap second({{some_rigid() * Vector3(0.3, 0.2, 0), 0.8, Vector3(0.05, 0.2, 0)}},
                           some_affine());
  const ComposedMap both(first, some_rigid(), second);
  const Points x = 3 * Points::Random(3, 5000);
  const Points expected = inverse(some_rigid()) * second(some_rigid() * first(x));
  EXPECT_LT((both(x) - expected).cwiseAbs().maxCoeff(), 1e-12);
  expect_support_holds(both, near_and_far());
  expect_gradient_is_the_limit_of_differences(both, 0.6 * Points::Random(3, 1000));
}

TEST(ComposedMap, BakedStaysWithinTolerance) {
  const AnalyticMap first = strong_bumps(0.5);
  const AnalyticMap second({{some_rigid() * Vector3(0.3, 0.2, 0), 0.8, Vector3(0.05, 0.1, 0)}},
                           some_affine());
  const ComposedMap both(first, some_rigid(), second);
  BakeOptions options;
  options.tolerance = 1e-3;
  options.error_points = 20000;
  const BakedMap stored(both.affine(), bake(both, options).pyramid);
  const Points x = 2 * Points::Random(3, 20000);
  const Points expected = inverse(some_rigid()) * second(some_rigid() * first(x));
  EXPECT_LT((stored(x) - expected).colwise().norm().maxCoeff(), 1.2e-3);
}

}  // namespace
}  // namespace bespoke
