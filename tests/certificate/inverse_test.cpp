#include "bespoke/certificate/inverse.h"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "bespoke/bake/bake.h"
#include "bespoke/certificate/certificate.h"
#include "bespoke/certificate/detail/cell_search.h"
#include "bespoke/error.h"
#include "support/analytic_map.h"
#include "support/finite_differences.h"

namespace bespoke {
namespace {

AffineMap some_affine() {
  AffineMap affine;
  affine.linear << 1.1, 0.1, 0, -0.1, 0.9, 0.05, 0, 0.02, 1.05;
  affine.offset << 0.1, 0.2, -0.3;
  return affine;
}

RigidTransform some_rigid() {
  RigidTransform rigid;
  rigid.rotation = Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  rigid.translation << 3, -1, 2;
  return rigid;
}

// Strong but orientation-preserving.
AnalyticMap strong_bumps(double scale = 1) {
  return AnalyticMap({{Vector3(0, 0, 0), 1.0, scale * Vector3(0.35, 0.1, -0.05)},
                      {Vector3(0.9, 0.5, 0), 0.7, scale * Vector3(-0.05, -0.15, 0.1)},
                      {Vector3(-0.2, 0.4, 0.1), 0.2, scale * Vector3(0, 0.05, 0.02)}},
                     some_affine());
}

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

TEST(CellSearch, FindsWhatNewtonFinds) {
  const BakedMap map = baked(strong_bumps(), 3e-3);
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

// Outside its support u is zero, bit for bit; inside somewhere it is not.
void expect_support_holds(const ElasticMap& map, const Points& x) {
  const Support support = map.support();
  const Points u = map.displacement(x);
  int outside = 0, moved = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    bool inside = false;
    const Vector3 seen = support.frame * Vector3(x.col(i));
    for (const BallCloud& cloud : support.clouds)
      inside = inside || ((cloud.centers.colwise() - seen).colwise().norm().array() <= cloud.radius).any();
    outside += !inside;
    moved += !u.col(i).isZero(0);
    if (!inside) {
      ASSERT_EQ(Vector3(u.col(i)), Vector3::Zero());
    }
  }
  EXPECT_GT(outside, 100);
  EXPECT_GT(moved, 100);
}

Points near_and_far() {
  Points x(3, 10000);
  x << Points::Random(3, 5000), 12 * Points::Random(3, 5000);
  return x;
}

void expect_gradient_is_the_limit_of_differences(const ElasticMap& map, const Points& x) {
  const Points gradient = map.displacement_gradient(x);
  const Points difference = test::finite_differences(map, x, 1e-4);
  const auto close = ((difference - gradient).colwise().norm().array() < 1e-3).count();
  // A few differences straddle cells, where the gradient jumps.
  EXPECT_GT(close, gradient.cols() * 9 / 10);
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
  const BakedMap stored = baked(both, 1e-3);
  const Points x = 2 * Points::Random(3, 20000);
  const Points expected = inverse(some_rigid()) * second(some_rigid() * first(x));
  EXPECT_LT((stored(x) - expected).colwise().norm().maxCoeff(), 1.2e-3);
}

}  // namespace
}  // namespace bespoke
