#include "bespoke/certificate/inverse.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "bespoke/bake/bake.h"
#include "bespoke/certificate/certificate.h"
#include "bespoke/error.h"
#include "bespoke/mapping/affine_map.h"
#include "support/elastic_map_contract.h"

namespace bespoke {
namespace {

using namespace test;

BakedMap baked(const ElasticMap& map, double tolerance) {
  BakeOptions options;
  options.tolerance = tolerance;
  options.error_points = 20000;
  return BakedMap(map.affine(), bake(map, options).pyramid);
}

TEST(PointwiseInverse, RoundTripIsFarBelowAVoxelOnACertifiedMap) {
  const BakedMap map = baked(strong_bumps(), 1e-3);
  ASSERT_TRUE(certify(map.pyramid(), map.affine()).is_bijection());
  const PointwiseInverse inverse(map);
  const Points x = 2 * Points::Random(3, 200000);
  const double voxel_size = map.pyramid().levels.back().voxel_size;
  EXPECT_LT((inverse(map(x)) - x).colwise().norm().maxCoeff(), 1e-3 * voxel_size);
  EXPECT_LT((map(inverse(x)) - x).colwise().norm().maxCoeff(), 1e-3 * voxel_size);
}

TEST(PointwiseInverse, IsExactlyAffineOutsideTheSupport) {
  const BakedMap map = baked(strong_bumps(), 1e-3);
  const PointwiseInverse inverse(map);
  const Points far = (Points::Random(3, 100).array() + 20).matrix();
  const AffineMap back = bespoke::inverse(map.affine());
  EXPECT_LT((inverse(far) - back * far).cwiseAbs().maxCoeff(), 1e-14 * 30);
}

TEST(PointwiseInverse, RefusesPointsThatAreNotFinite) {
  const BakedMap map = baked(strong_bumps(), 1e-2);
  const PointwiseInverse inverse(map);
  EXPECT_THROW(inverse(Vector3(std::nan(""), 0, 0)), InvalidInput);
  AffineMap flat;
  flat.linear.setZero();
  const BakedMap singular(flat, Pyramid{});
  EXPECT_THROW(PointwiseInverse{singular}, InvalidInput);
}

TEST(InverseMap, UndoesTheWholeMapping) {
  const BakedMap map = baked(strong_bumps(), 1e-3);
  const RigidTransform b_from_a = some_rigid();
  const InverseMap back(map, b_from_a);
  const Points x = 2 * Points::Random(3, 20000);
  const Points in_b = b_from_a * map(x);
  const Points returned = inverse(b_from_a) * back(in_b);
  EXPECT_LT((returned - x).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(InverseMap, KeepsTheContractOfAnElasticMap) {
  const BakedMap map = baked(strong_bumps(), 1e-3);
  const InverseMap back(map, some_rigid());
  const Points in_b = some_rigid() * Points(some_affine() * near_and_far());
  expect_support_holds(back, in_b);
  const Points inside = some_rigid() * Points(some_affine() * Points(0.6 * Points::Random(3, 1000)));
  expect_gradient_is_the_limit_of_differences(back, inside);
}

TEST(InverseMap, BakedRoundTripStaysWithinTheTwoTolerances) {
  const double tolerance = 1e-3;
  const BakedMap map = baked(strong_bumps(), tolerance);
  const InverseMap exact(map, some_rigid());
  const BakedMap back = baked(exact, tolerance);
  EXPECT_TRUE(certify(back.pyramid(), back.affine()).is_bijection());
  const Points x = 2 * Points::Random(3, 20000);
  const Points returned = inverse(some_rigid()) * back(some_rigid() * map(x));
  EXPECT_LT((returned - x).colwise().norm().maxCoeff(), 2 * tolerance);
}

}  // namespace
}  // namespace bespoke
