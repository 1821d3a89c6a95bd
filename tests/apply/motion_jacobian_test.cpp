#include "bespoke/apply/motion_jacobian.h"
#include "apply/motions.h"

#include <gtest/gtest.h>

#include <memory>

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/mapping/elastic_chain.h"
#include "support/analytic_map.h"

namespace bespoke {
namespace {

std::shared_ptr<ElasticMap> some_map(double turn) {
  AffineMap affine;
  affine.linear = Eigen::AngleAxisd(turn, Vector3::UnitZ()) * Matrix3(Vector3(1, 1.2, 0.9).asDiagonal());
  affine.offset = {0.1, 0.2, 0.3};
  return std::make_shared<AnalyticMap>(std::vector<Bump>{{{0, 0, 0}, 1.5, {0.2, -0.1, 0.3}}}, affine);
}

/// Largest difference between the Jacobians and central differences of what apply_mapping computes.
double deviation(const ElasticMap& map, double t, const MotionOptions& motion) {
  constexpr double step = 1e-5;
  const Points x = Points{{0.1, 0.5, 3, -0.3}, {0.2, -0.5, 0, 0.3}, {0, 0.1, 0, 0.2}};
  const Points jacobians = motion_jacobian(map, test::some_motion(), x, {t}, motion).front();
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 offset = step * Vector3::Unit(axis);
    const auto moved = [&](const Points& at) {
      return apply_mapping(map, test::some_motion(), at, {t}, motion).frames.front();
    };
    const Points slope = (moved(x.colwise() + offset) - moved(x.colwise() - offset)) / (2 * step);
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      largest = std::max(largest, (jacobians.col(3 * i + axis) - slope.col(i)).norm());
  }
  return largest;
}

TEST(MotionJacobian, AgreesWithFiniteDifferencesInEveryOrder) {
  const std::shared_ptr<ElasticMap> map = some_map(0.2);
  for (const double t : {0.0, 0.3, 1.0, 1.2})
    for (const RotationPath path : {RotationPath::geodesic, RotationPath::euler})
      for (const MappingOrder order : {MappingOrder::elastic_first, MappingOrder::rigid_first,
                                       MappingOrder::moving_point, MappingOrder::linear})
        EXPECT_LT(deviation(*map, t, {path, order}), 1e-8) << t << ' ' << static_cast<int>(order);
}

TEST(MotionJacobian, AgreesWithFiniteDifferencesAlongTheFlowOfAChain) {
  const ElasticChain chain({some_map(0.3), some_map(-0.5), some_map(0.4)});
  for (const double t : {0.0, 0.2, 0.5, 0.9, 1.0})
    EXPECT_LT(deviation(chain, t, {RotationPath::flow, MappingOrder::elastic_first}), 1e-8) << t;
}

TEST(MotionJacobian, IsTheIdentityAtRest) {
  const Points jacobians =
      motion_jacobian(*some_map(0.2), test::some_motion(), Points::Random(3, 5), {0}).front();
  EXPECT_EQ(jacobians, Points(Matrix3::Identity().replicate(1, 5)));
}

}  // namespace
}  // namespace bespoke
