#include "bespoke/pattern/self_overlap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace bespoke {
namespace {

/// The outline of a ring's sector of `turns`: above one turn it covers places twice.
Eigen::Matrix2Xd sector(double turns) {
  constexpr int count = 60;
  Eigen::Matrix2Xd outline(2, 2 * count);
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * turns * k / (count - 1);
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    outline.col(k) = 2 * direction;
    outline.col(2 * count - 1 - k) = direction;
  }
  return outline;
}

std::vector<int> whole(const Eigen::Matrix2Xd& places) {
  std::vector<int> outline(static_cast<std::size_t>(places.cols()));
  std::iota(outline.begin(), outline.end(), 0);
  return outline;
}

TEST(OutlineCrossing, IsThatOfTheFirstEdges) {
  EXPECT_FALSE(outline_crossing(sector(0.9), whole(sector(0.9))));
  const Eigen::Matrix2Xd twice = sector(1.1);
  const auto crossing = outline_crossing(twice, whole(twice));
  ASSERT_TRUE(crossing);
  EXPECT_LT((*crossing)[0], (*crossing)[1]);
}

TEST(OutlineCrossing, OfATriangleIsNone) {
  Eigen::Matrix2Xd triangle(2, 3);
  triangle << 0, 1, 0, 0, 0, 1;
  EXPECT_FALSE(outline_crossing(triangle, {0, 1, 2}));
}

TEST(OutlineCrossing, CountsATouch) {
  Eigen::Matrix2Xd places(2, 6);
  places << 0, 2, 2, 1, 0, 0, 0, 0, 2, 0, 2, 1;  // its fourth vertex lies on the first edge
  EXPECT_TRUE(outline_crossing(places, whole(places)));
}

}  // namespace
}  // namespace bespoke
