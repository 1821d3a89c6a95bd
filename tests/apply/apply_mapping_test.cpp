#include "bespoke/apply/apply_mapping.h"
#include "apply/motions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bespoke/error.h"

namespace bespoke {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// u = (1 − |x|)² x inside the unit ball, 0 outside.
class BumpMap : public ElasticMap {
 public:
  AffineMap affine() const override {
    AffineMap map;
    map.linear << 1, 0.5, 0, 0, 2, 0, 0, 0, 1;
    map.offset = {1, 2, 3};
    return map;
  }
  Points displacement(const Points& x) const override {
    Points u(3, x.cols());
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const double gap = std::max(0.0, 1 - x.col(i).norm());
      u.col(i) = gap * gap * x.col(i);
    }
    return u;
  }
  Points displacement_gradient(const Points& x) const override { return Points::Zero(3, 3 * x.cols()); }
  Support support() const override { return {}; }
};

Points some_points() {
  Points x(3, 4);
  x << 0.1, 0.5, 2, -0.3, 0.2, -0.5, 0, 0.3, 0, 0.1, 0, 0.2;
  return x;
}

TEST(ApplyMapping, IsTheIdentityAtZeroAndTheWholeMapAtOne) {
  const BumpMap map;
  const Points x = some_points();
  const AppliedPoints applied = apply_mapping(map, test::some_motion(), x, {0, 1});
  EXPECT_EQ(applied.frames[0], x);
  EXPECT_LT((applied.frames[1] - test::some_motion() * map(x)).norm(), 1e-14);
}

TEST(ApplyMapping, FollowsEquationOneInBetween) {
  const BumpMap map;
  const Points x = some_points();
  const double t = 0.4;
  const Matrix3 rotation = Eigen::AngleAxisd(0.7 * t, Vector3(1, 1, 0).normalized()).toRotationMatrix();
  const Points expected =
      (rotation * ((1 - t) * x + t * map(x))).colwise() + t * test::some_motion().translation;
  EXPECT_LT((apply_mapping(map, test::some_motion(), x, {t}).frames[0] - expected).norm(), 1e-13);
}

TEST(ApplyMapping, FollowsEquationNineteenAtTheMovingPoint) {
  const BumpMap map;
  const Points x = some_points();
  const RigidTransform gamma = test::some_motion();
  const std::vector<double> times{0, 0.4, 1};
  const AppliedPoints applied =
      apply_mapping(map, gamma, x, times, {RotationPath::geodesic, MappingOrder::moving_point});
  EXPECT_EQ(applied.frames[0], x);
  EXPECT_LT((applied.frames[2] - gamma * map(x)).norm(), 1e-14);
  const double t = times[1];
  const Matrix3 rotation = Eigen::AngleAxisd(0.7 * t, Vector3(1, 1, 0).normalized()).toRotationMatrix();
  const Points y = (rotation * x).colwise() + t * gamma.translation;
  const Points expected = (1 - t) * y + t * (gamma * map(inverse(gamma) * y));
  EXPECT_LT((applied.frames[1] - expected).norm(), 1e-13);
  // E requested at the resting points is another motion.
  const Points at_rest =
      apply_mapping(map, gamma, x, {t}, {RotationPath::geodesic, MappingOrder::rigid_first}).frames[0];
  EXPECT_GT((applied.frames[1] - at_rest).norm(), 0.1);
}

TEST(ApplyMapping, CountsWhoTookTheAffineFallback) {
  const ApplySummary summary = apply_mapping(BumpMap(), test::some_motion(), some_points(), {1}).summary;
  EXPECT_EQ(summary.points, 4u);
  EXPECT_EQ(summary.in_band, 3u);
  EXPECT_EQ(summary.affine_only, 1u);
  EXPECT_THAT(to_string(summary),
              HasSubstr("4 points: 3 within reach of the source, 1 beyond it and moved with the whole"));
}

TEST(ApplyMapping, OfManyPointsIsThatOfEach) {
  const BumpMap map;
  const Points x = 2 * Points::Random(3, 40000);
  const AppliedPoints applied = apply_mapping(map, test::some_motion(), x, {0.3, 1});
  EXPECT_LT((applied.frames[1] - test::some_motion() * map(x)).cwiseAbs().maxCoeff(), 1e-13);
  std::size_t inside = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) inside += x.col(i).norm() < 1;
  EXPECT_EQ(applied.summary.in_band, inside);
  for (const Eigen::Index i : {0, 16383, 16384, 39999}) {
    const Points alone = apply_mapping(map, test::some_motion(), Points(x.col(i)), {0.3}).frames[0];
    EXPECT_LT((applied.frames[0].col(i) - alone.col(0)).norm(), 1e-13);
  }
}

TEST(ApplyMapping, OfNothingIsNothing) {
  const AppliedPoints applied = apply_mapping(BumpMap(), test::some_motion(), Points(3, 0), {0.5});
  ASSERT_EQ(applied.frames.size(), 1u);
  EXPECT_EQ(applied.frames[0].cols(), 0);
  EXPECT_TRUE(apply_mapping(BumpMap(), test::some_motion(), some_points(), {}).frames.empty());
}

TEST(ApplyMapping, NamesTheFirstPointOrTimeThatIsNotFinite) {
  Points x = some_points();
  x(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { apply_mapping(BumpMap(), test::some_motion(), x, {1}); },
              ThrowsMessage<InvalidInput>(HasSubstr("point 2")));
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT(
      [&] {
        apply_mapping(BumpMap(), test::some_motion(), some_points(), {0, infinity});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("time 1")));
}

}  // namespace
}  // namespace bespoke
