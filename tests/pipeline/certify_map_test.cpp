#include "bespoke/pipeline/certify_map.h"

#include <gtest/gtest.h>

#include "asset/small_asset.h"
#include "bespoke/bake/bake.h"
#include "bespoke/error.h"
#include "support/analytic_map.h"

namespace bespoke {
namespace {

// u with ∂u/∂x down to −2.05 · amplitude: the step folds beyond amplitude 0.49, and at t beyond 0.49 /
// amplitude.
MapStep step(double amplitude) {
  const AnalyticMap map({{Vector3::Zero(), 1.0, Vector3(amplitude, 0, 0)}});
  BakeOptions options;
  options.tolerance = 0.01;
  options.error_points = 1000;
  Pyramid pyramid = bake(map, options).pyramid;
  for (PyramidLevel& level : pyramid.levels)
    for (float& value : level.values) value *= 4;
  Certificate certificate = certify(pyramid, map.affine());
  return {map.affine(), std::move(pyramid), std::move(certificate)};
}

Asset asset_of(std::vector<MapStep> steps) {
  Asset asset = test::small_asset();
  asset.steps = std::move(steps);
  asset.path = RotationPath::flow;
  return asset;
}

TEST(CertifyMap, OfOneStepIsThatOfItsCells) {
  const Asset asset = asset_of({step(0.2)});
  for (const double t : {0.25, 1.0}) {
    const Certificate expected = certify(asset.steps[0].pyramid, asset.steps[0].affine, t);
    const Certificate found = certify_map(asset, t);
    EXPECT_EQ(found.certified, expected.certified);
    EXPECT_EQ(found.folded, expected.folded);
    EXPECT_EQ(found.min_determinant, expected.min_determinant);
  }
}

TEST(CertifyMap, OfAFlowIsThatOfTheStepsSoFar) {
  // The second step folds in its second half.
  const Asset asset = asset_of({step(0.05), step(0.2)});
  ASSERT_TRUE(asset.steps[0].certificate.is_bijection());
  ASSERT_FALSE(asset.steps[1].certificate.is_bijection());
  EXPECT_TRUE(certify_map(asset, 0.5).is_bijection());
  EXPECT_TRUE(certify_map(asset, 0.6).is_bijection());
  EXPECT_FALSE(certify_map(asset, 1).is_bijection());
  EXPECT_EQ(certify_map(asset, 0.5).certified, certify_map(asset, 0.25).certified);
  EXPECT_GT(certify_map(asset, 0.6).certified, certify_map(asset, 0.5).certified);
}

TEST(CertifyMap, RefusesTimesOfAChainThatGoesStraight) {
  Asset asset = asset_of({step(0.05), step(0.05)});
  asset.path = RotationPath::geodesic;
  EXPECT_THROW(certify_map(asset, 0.5), InvalidInput);
  EXPECT_TRUE(certify_map(asset, 1).is_bijection());
}

}  // namespace
}  // namespace bespoke
