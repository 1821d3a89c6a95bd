#include "bespoke/surface_fit/graph/anchor_limits.h"

#include <gtest/gtest.h>

#include <cmath>

namespace bespoke {
namespace {

constexpr double model_area = 3, pair_distance = 0.05, smoothness = 0.2;

Eigen::VectorXd all(double value) { return Eigen::VectorXd::Constant(3, value); }

AnchorLimits limits_of(const Eigen::VectorXd& sigmas) { return {sigmas, model_area, {}}; }

TEST(AnchorLimits, AreNoneForExactAnchorsAndBeforeThePairs) {
  const Eigen::VectorXd none = all(0);
  AnchorLimits exact = limits_of(none);
  for (const double limit : exact.next({none, pair_distance, smoothness})) EXPECT_TRUE(std::isinf(limit));
  AnchorLimits inaccurate = limits_of(all(0.1));
  for (const double limit : inaccurate.next({none, 0, smoothness})) EXPECT_TRUE(std::isinf(limit));
}

TEST(AnchorLimits, AreTheRatioOfTheVariances) {
  const Eigen::VectorXd none = all(0);
  const double along = AnchorSettings{}.along_surface;
  AnchorLimits limits = limits_of(Vector3(0.1, 0.2, 0.4));
  const std::vector<double> found = limits.next({none, pair_distance, smoothness});
  const double variance = pair_distance * pair_distance + along * along;
  EXPECT_NEAR(found[0], smoothness * smoothness / model_area * variance / (0.1 * 0.1), 1e-15);
  EXPECT_NEAR(found[0] / found[1], 4, 1e-12);
  EXPECT_NEAR(found[1] / found[2], 4, 1e-12);
}

TEST(AnchorLimits, RiseWhileTheAnchorsAreMissedByMoreThanTheirErrors) {
  constexpr double sigma = 0.1;
  const Eigen::VectorXd none = all(0), missed = all(5 * sigma), typical = all(sigma);
  AnchorLimits limits = limits_of(all(sigma));
  const double base = limits.next({none, pair_distance, smoothness})[0];
  EXPECT_EQ(limits.next({typical, pair_distance, smoothness})[0], base);
  const double once = limits.next({missed, pair_distance, smoothness})[0];
  const double twice = limits.next({missed, pair_distance, smoothness})[0];
  EXPECT_GT(once, base);
  EXPECT_GT(twice, once);
  EXPECT_LE(once, AnchorSettings{}.max_reinforced * base * (1 + 1e-12));
  for (int k = 0; k < 3; ++k) limits.next({none, pair_distance, smoothness});
  EXPECT_EQ(limits.next({none, pair_distance, smoothness})[0], base);
}

TEST(AnchorLimits, FollowTheMedianSoThatOneOutlierChangesNothing) {
  AnchorLimits calm = limits_of(all(0.1)), outlier = limits_of(all(0.1));
  const Eigen::VectorXd few = all(0.05), one = Vector3(0.05, 30, 0.05);
  EXPECT_EQ(calm.next({few, pair_distance, smoothness}), outlier.next({one, pair_distance, smoothness}));
}

}  // namespace
}  // namespace bespoke
