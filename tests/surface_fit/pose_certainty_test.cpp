#include "bespoke/surface_fit/graph/pose_certainty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace bespoke {
namespace {

Points on_x_axis(std::initializer_list<double> places) {
  Points x = Points::Zero(3, static_cast<Eigen::Index>(places.size()));
  Eigen::Index i = 0;
  for (const double place : places) x(0, i++) = place;
  return x;
}

TEST(PoseCertainty, FallsWithTheDistanceOfTheThirdAnchor) {
  const Eigen::VectorXd certainty = pose_certainty(on_x_axis({0, 1, -3}), on_x_axis({9, 0, 1, 2}), 2);
  EXPECT_DOUBLE_EQ(certainty[0], std::exp(-1.0));
  EXPECT_DOUBLE_EQ(certainty[1], std::exp(-0.25));
  EXPECT_DOUBLE_EQ(certainty[2], std::exp(-6.25));
}

TEST(PoseCertainty, IsOneAmongThreeAndNoneOfTwo) {
  EXPECT_EQ(pose_certainty(on_x_axis({5}), on_x_axis({5, 5, 5}), 0.1)[0], 1);
  EXPECT_EQ(pose_certainty(on_x_axis({5}), on_x_axis({5, 5}), 0.1)[0], 0);
}

}  // namespace
}  // namespace bespoke
