#include "bespoke/mapping/mapping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

constexpr RotationPath paths[] = {RotationPath::geodesic, RotationPath::euler};
constexpr MappingOrder orders[] = {MappingOrder::elastic_first, MappingOrder::rigid_first,
                                   MappingOrder::moving_point, MappingOrder::linear};

struct Motion {
  Points x = test::random_points(40, 1);
  Points elastic_image = x + 0.1 * test::random_points(40, 2);
  RigidTransform target_from_source{test::random_rotation(3), Vector3(0.5, -2, 1)};
};

TEST(MovePoints, IsTheIdentityAtZeroExactly) {
  const Motion motion;
  for (const RotationPath path : paths)
    for (const MappingOrder order : orders)
      EXPECT_EQ(move_points(motion.x, motion.elastic_image, motion.target_from_source, 0, {path, order}),
                motion.x);
}

TEST(MovePoints, IsTheRigidPartAfterTheElasticOneAtOneExactly) {
  const Motion motion;
  const Points expected = motion.target_from_source * motion.elastic_image;
  for (const RotationPath path : paths)
    for (const MappingOrder order : orders)
      EXPECT_EQ(move_points(motion.x, motion.elastic_image, motion.target_from_source, 1, {path, order}),
                expected);
}

TEST(MovePoints, ReachesBothEndsContinuously) {
  const Motion motion;
  constexpr double small = 1e-9;
  for (const RotationPath path : paths)
    for (const MappingOrder order : orders)
      for (const double end : {0.0, 1.0}) {
        const auto at = [&](double t) {
          return move_points(motion.x, motion.elastic_image, motion.target_from_source, t, {path, order});
        };
        EXPECT_LT((at(end + small) - at(end)).norm(), 1e-7);
        EXPECT_LT((at(end - small) - at(end)).norm(), 1e-7);
      }
}

TEST(MovePoints, WithoutElasticChangeIsTheRigidMotionInBothRigidOrders) {
  const Motion motion;
  for (const MappingOrder order : {MappingOrder::elastic_first, MappingOrder::rigid_first}) {
    const Points halfway =
        move_points(motion.x, motion.x, motion.target_from_source, 0.5, {RotationPath::geodesic, order});
    // Distances between points are those of a rigid motion; plain blending shrinks them (Fig. 1).
    EXPECT_NEAR((halfway.col(0) - halfway.col(1)).norm(), (motion.x.col(0) - motion.x.col(1)).norm(), 1e-13);
  }
  const Points blended = move_points(motion.x, motion.x, motion.target_from_source, 0.5,
                                     {RotationPath::geodesic, MappingOrder::linear});
  EXPECT_LT((blended.col(0) - blended.col(1)).norm(), 0.99 * (motion.x.col(0) - motion.x.col(1)).norm());
}

TEST(MovePoints, WithoutRotationIsLinearInTimeWhereverEIsAskedForAtRest) {
  Motion motion;
  motion.target_from_source.rotation.setIdentity();
  const Points end = motion.target_from_source * motion.elastic_image;
  for (const MappingOrder order :
       {MappingOrder::elastic_first, MappingOrder::rigid_first, MappingOrder::linear})
    for (const double t : {-0.5, 0.25, 2.0})
      EXPECT_LT((move_points(motion.x, motion.elastic_image, motion.target_from_source, t,
                             {RotationPath::geodesic, order}) -
                 ((1 - t) * motion.x + t * end))
                    .norm(),
                1e-13);
}

/// Ψ(t) with E requested wherever the order requires it.
template <class Elastic>
Points psi(const Elastic& elastic, const Points& x, const RigidTransform& target_from_source, double t,
           MappingOrder order) {
  const MotionOptions options{RotationPath::geodesic, order};
  return move_points(x, elastic(elastic_argument(x, target_from_source, t, options)), target_from_source, t,
                     options);
}

Points bulge(const Points& x) {
  Points result = x;
  for (Eigen::Index i = 0; i < x.cols(); ++i) result(0, i) += 0.3 * std::exp(-4 * x.col(i).squaredNorm());
  return result;
}

// Eq. 19 as printed, with E' = Γ∘E∘Γ⁻¹ written out.
TEST(MovingPoint, AsksForTheElasticMapWhereThePointIs) {
  const Motion motion;
  const RigidTransform& gamma = motion.target_from_source;
  for (const double t : {0.25, 0.5, 0.9}) {
    const Matrix3 rotation = rotation_at(gamma.rotation, RotationPath::geodesic, t);
    const Points y = (rotation * motion.x).colwise() + t * gamma.translation;
    const Points back = gamma.rotation.transpose() * (y.colwise() - gamma.translation);
    const Points expected = (1 - t) * y + t * ((gamma.rotation * bulge(back)).colwise() + gamma.translation);
    EXPECT_LT((psi(bulge, motion.x, gamma, t, MappingOrder::moving_point) - expected).norm(), 1e-12);
  }
}

// A pure scaling E(x) = s x and a translation T: on the way, Eq. 19 parts from Eq. 1 by t (1−t) (1−s) T.
TEST(MovingPoint, PartsFromThePapersOwnOrderByAKnownVector) {
  const Points x = test::random_points(20, 5);
  const Vector3 translation(3, -1, 2);
  const RigidTransform gamma{Matrix3::Identity(), translation};
  constexpr double s = 1.4;
  const auto scaling = [s](const Points& points) -> Points { return s * points; };
  for (const double t : {0.25, 0.5, 0.75}) {
    const Points difference = psi(scaling, x, gamma, t, MappingOrder::moving_point) -
                              psi(scaling, x, gamma, t, MappingOrder::elastic_first);
    EXPECT_LT((difference.colwise() - t * (1 - t) * (1 - s) * translation).norm(), 1e-13);
  }
}

// Far from where it is at rest a point finds no elastic change: it moves rigidly until it arrives. In Fig. 4
// the change grows evenly all the way.
TEST(MovingPoint, FindsTheElasticChangeOnlyNearTheTarget) {
  const Points x = 0.3 * test::random_points(20, 6);
  const RigidTransform gamma{test::random_rotation(2), Vector3(40, 0, 0)};
  const auto elastic_change = [&](double t, MappingOrder order) {
    const auto none = [](const Points& points) { return points; };
    return (psi(bulge, x, gamma, t, order) - psi(none, x, gamma, t, order)).colwise().norm().maxCoeff();
  };
  const double whole = (bulge(x) - x).colwise().norm().maxCoeff();
  EXPECT_LT(elastic_change(0.5, MappingOrder::moving_point), 1e-12);
  EXPECT_NEAR(elastic_change(0.5, MappingOrder::rigid_first), 0.5 * whole, 1e-12);
  EXPECT_NEAR(elastic_change(0.5, MappingOrder::elastic_first), 0.5 * whole, 1e-12);
  for (const MappingOrder order : {MappingOrder::moving_point, MappingOrder::rigid_first})
    EXPECT_NEAR(elastic_change(1, order), whole, 1e-12);
}

TEST(ElasticArgument, IsThePointItselfInAllOtherOrdersAndAtBothEnds) {
  const Motion motion;
  for (const MappingOrder order : orders)
    for (const double t : {0.0, 0.5, 1.0}) {
      const Points argument =
          elastic_argument(motion.x, motion.target_from_source, t, {RotationPath::geodesic, order});
      EXPECT_EQ(argument == motion.x, order != MappingOrder::moving_point || t != 0.5);
    }
  EXPECT_THROW(elastic_argument(motion.x, motion.target_from_source, std::nan("")), InvalidInput);
}

TEST(MovePoints, OfNoPointsIsEmpty) { EXPECT_EQ(move_points(Points(3, 0), Points(3, 0), {}, 0.5).cols(), 0); }

TEST(MovePoints, RefusesWhatItCannotMove) {
  const Motion motion;
  EXPECT_THROW(move_points(motion.x, Points(3, 2), motion.target_from_source, 0.5), InvalidInput);
  for (const double t : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(move_points(motion.x, motion.elastic_image, motion.target_from_source, t), InvalidInput);
}

}  // namespace
}  // namespace bespoke
