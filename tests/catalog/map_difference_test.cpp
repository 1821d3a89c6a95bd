#include "bespoke/catalog/map_difference.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "catalog/compared_assets.h"

namespace bespoke {
namespace {

using test::baked_asset;
using test::chain_asset;

TEST(MapDifference, OfAMapFromItselfIsZero) {
  for (const Asset& asset : {baked_asset({0.1, 0.2, 0}, 1e-3), chain_asset(1e-3)}) {
    const MapDifference difference = map_difference(asset, asset, {Points::Random(3, 100)});
    EXPECT_GT(difference.band.distance.count, 100'000u);
    EXPECT_EQ(difference.band.distance.max, 0);
    EXPECT_EQ(difference.products.at(0).distance.max, 0);
    EXPECT_EQ(difference.products.at(0).distance.count, 100u);
    EXPECT_EQ(difference.affine, 0);
  }
}

TEST(MapDifference, IsTheSameBothWays) {
  const Asset a = baked_asset({0.1, 0.2, 0}, 1e-3), b = chain_asset(3e-3);
  const MapDifference forth = map_difference(a, b, {}), back = map_difference(b, a, {});
  EXPECT_GT(forth.band.distance.max, 0);
  EXPECT_EQ(forth.band.distance.max, back.band.distance.max);
  EXPECT_EQ(forth.band.distance.p99, back.band.distance.p99);
  EXPECT_EQ(forth.band.largest, back.band.largest);
  EXPECT_EQ(forth.band.image_a, back.band.image_b);
  EXPECT_EQ(forth.affine, back.affine);
}

TEST(MapDifference, OfTwoBakesOfOneMapIsBelowTheSumOfTheirTolerances) {
  const double coarse = 4e-3, fine = 2e-4;
  const MapDifference difference =
      map_difference(baked_asset({0.1, 0.2, 0}, coarse), baked_asset({0.1, 0.2, 0}, fine), {});
  EXPECT_GT(difference.band.distance.max, fine);
  EXPECT_LE(difference.band.distance.max, coarse + fine);
  EXPECT_EQ(difference.affine, 0);
}

TEST(MapDifference, OfARigidMotionIsItsLengthEverywhere) {
  const Asset a = baked_asset({0.1, 0.2, 0}, 1e-3);
  Asset b = a;
  b.target_from_source.translation += Vector3(0.3, 0, 0.4);
  const MapDifference difference = map_difference(a, b, {});
  EXPECT_NEAR(difference.band.distance.min, 0.5, 1e-12);
  EXPECT_NEAR(difference.band.distance.max, 0.5, 1e-12);
  EXPECT_EQ(difference.band.elastic.max, 0);
  EXPECT_NEAR(difference.affine, 0.5, 1e-12);
}

TEST(MapDifference, SaysWhereItIsLargest) {
  // u differs in one bump around (0.5, 0, 0), by 0.1 at most.
  const Asset a = baked_asset({0.1, 0.2, 0}, 1e-4);
  Asset b = a;
  const AnalyticMap other({{Vector3(0.5, 0, 0), 1.0, Vector3(0.1, 0.2, 0.1)},
                           {Vector3(-0.5, 0.3, 0), 0.8, 0.5 * Vector3(0.1, 0.2, 0)}});
  BakeOptions options;
  options.tolerance = 1e-4;
  b.steps.front().pyramid = bake(other, options).pyramid;
  const PointDifference found = map_difference(a, b, {}).band;
  EXPECT_NEAR(found.distance.max, 0.1, 2e-3);
  EXPECT_LE((found.largest - Vector3(0.5, 0, 0)).norm(), 0.1);
  EXPECT_NEAR((found.image_a - found.image_b).norm(), found.distance.max, 1e-12);
}

TEST(MapDifference, OfMapsWithoutABandIsThatOfTheirAffineParts) {
  Asset a = test::small_asset();
  a.steps.front().pyramid.levels.clear();
  Asset b = a;
  b.steps.front().affine.offset += Vector3(0, 0.25, 0);
  const MapDifference difference = map_difference(a, b, {});
  EXPECT_NEAR(difference.band.distance.max, 0.25, 1e-12);
  EXPECT_NEAR(difference.affine, 0.25, 1e-12);
}

TEST(PointsOfBands, LieWhereUMayBeNonzero) {
  const Asset asset = baked_asset({0.1, 0.2, 0}, 1e-3);
  const Points points = points_of_bands(asset, asset, 3000);
  ASSERT_GT(points.cols(), 5000);
  const Points u = baked_chain(asset.steps).displacement(points);
  EXPECT_GT((u.colwise().norm().array() > 0).count(), points.cols() / 2);
}

TEST(MapDifference, RefusesPointsThatAreNotFinite) {
  const Asset asset = test::small_asset();
  EXPECT_THROW(map_difference(asset, asset, {Points::Constant(3, 2, std::nan(""))}), InvalidInput);
}

}  // namespace
}  // namespace bespoke
