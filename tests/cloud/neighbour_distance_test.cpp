#include "bespoke/cloud/detail/neighbour_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/random_points.h"

namespace bespoke {
namespace {

double by_all_pairs(const Points& points, Eigen::Index i, std::size_t k) {
  std::vector<double> distances;
  for (Eigen::Index j = 0; j < points.cols(); ++j)
    distances.push_back((points.col(j) - points.col(i)).norm());
  std::sort(distances.begin(), distances.end());
  return distances[k];
}

TEST(NeighbourDistances, AreThoseOfAllPairs) {
  const Points points = test::random_points(700, 5);
  for (const std::size_t k : {1u, 20u}) {
    const std::vector<double> found = neighbour_distances(points, k);
    for (Eigen::Index i = 0; i < points.cols(); ++i)
      EXPECT_NEAR(found[static_cast<std::size_t>(i)], by_all_pairs(points, i, k), 1e-15);
  }
}

TEST(NeighbourDistances, AreInfiniteFarAwayAndExactWhereMuchDenser) {
  Points points(3, 1001);
  points.leftCols(500) = test::random_points(500, 1);
  points.middleCols(500, 500) = 0.01 * test::random_points(500, 2);
  points.col(1000) = Vector3(1000, 0, 0);
  const std::vector<double> found = neighbour_distances(points, 10);
  EXPECT_TRUE(std::isinf(found[1000]));
  for (Eigen::Index i = 500; i < 1000; ++i)
    EXPECT_NEAR(found[static_cast<std::size_t>(i)], by_all_pairs(points, i, 10), 1e-15);
}

TEST(NeighbourDistances, OfOnePointMoreThanNeighbours) {
  const Points points = test::random_points(3, 4);
  const std::vector<double> found = neighbour_distances(points, 2);
  for (Eigen::Index i = 0; i < 3; ++i)
    EXPECT_NEAR(found[static_cast<std::size_t>(i)], by_all_pairs(points, i, 2), 1e-15);
}

}  // namespace
}  // namespace bespoke
