#include "bespoke/mapping/mapping.h"

#include <gtest/gtest.h>

#include <limits>

#include "bespoke/error.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

constexpr RotationPath paths[] = {RotationPath::geodesic, RotationPath::euler};
constexpr MappingOrder orders[] = {MappingOrder::elastic_first, MappingOrder::rigid_first,
                                   MappingOrder::linear};

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

TEST(MovePoints, WithoutRotationIsLinearInTimeInEveryOrder) {
  Motion motion;
  motion.target_from_source.rotation.setIdentity();
  const Points end = motion.target_from_source * motion.elastic_image;
  for (const MappingOrder order : orders)
    for (const double t : {-0.5, 0.25, 2.0})
      EXPECT_LT((move_points(motion.x, motion.elastic_image, motion.target_from_source, t,
                             {RotationPath::geodesic, order}) -
                 ((1 - t) * motion.x + t * end))
                    .norm(),
                1e-13);
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
