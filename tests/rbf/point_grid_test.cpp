#include "bespoke/rbf/point_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "bespoke/error.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

std::vector<int> found(const PointGrid& grid, const Vector3& x, double radius) {
  std::vector<int> indices;
  grid.for_each_within(x, radius, [&](int index, double) { indices.push_back(index); });
  std::sort(indices.begin(), indices.end());
  return indices;
}

std::vector<int> found_naively(const Points& points, const Vector3& x, double radius) {
  std::vector<int> indices;
  for (int i = 0; i < points.cols(); ++i)
    if ((points.col(i) - x).squaredNorm() <= radius * radius) indices.push_back(i);
  return indices;
}

TEST(PointGrid, VisitsExactlyThePointsWithinTheRadius) {
  const Points points = test::random_points(500, 1);
  const Points queries = 2 * test::random_points(100, 2);
  for (const double cell : {0.05, 0.3, 5.0}) {
    const PointGrid grid(points, cell);
    for (const double radius : {0.0, 0.1, 0.3, 1.0, 10.0})
      for (const Vector3 x : queries.colwise())
        EXPECT_EQ(found(grid, x, radius), found_naively(points, x, radius));
    EXPECT_EQ(found(grid, points.col(7), 0).front(), 7);
  }
}

TEST(PointGrid, TellsTheSquaredDistance) {
  const Points points = test::random_points(50, 3);
  const PointGrid grid(points, 0.5);
  const Vector3 x(0.1, 0.2, 0.3);
  grid.for_each_within(x, 1, [&](int index, double squared_distance) {
    EXPECT_EQ(squared_distance, (points.col(index) - x).squaredNorm());
  });
}

TEST(PointGrid, HoldsDuplicatesAndPlanarPoints) {
  Points points = test::random_points(60, 4);
  points.row(1).setConstant(2);
  points.col(9) = points.col(3);
  const PointGrid grid(points, 0.1);
  EXPECT_EQ(found(grid, points.col(3), 0), (std::vector<int>{3, 9}));
  EXPECT_EQ(grid.size(), 60);
}

TEST(PointGrid, HoldsPointsFarApartInTinyCells) {
  Points points = 1e9 * test::random_points(20, 5);
  points.col(1) = points.col(0) + Vector3(1e-3, 0, 0);
  const PointGrid grid(points, 1e-3);
  EXPECT_EQ(found(grid, points.col(0), 0.01), (std::vector<int>{0, 1}));
}

TEST(PointGrid, OfNothingVisitsNothing) {
  const PointGrid grid(Points(3, 0), 1);
  EXPECT_EQ(grid.size(), 0);
  EXPECT_TRUE(found(grid, Vector3::Zero(), 100).empty());
}

TEST(PointGrid, FindsNothingAtInfinity) {
  const PointGrid grid(test::random_points(10, 6), 0.5);
  EXPECT_TRUE(found(grid, Vector3::Constant(1e300), 1).empty());
  EXPECT_TRUE(found(grid, Vector3(std::numeric_limits<double>::infinity(), 0, 0), 1).empty());
}

TEST(PointGrid, RefusesWhatItCannotSort) {
  const Points points = test::random_points(3, 7);
  EXPECT_THROW(PointGrid(points, 0), InvalidInput);
  EXPECT_THROW(PointGrid(points, std::numeric_limits<double>::quiet_NaN()), InvalidInput);
  Points broken = points;
  broken(2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(PointGrid(broken, 1), InvalidInput);
}

TEST(ThinPoints, KeepsApartAndCovers) {
  const Points points = test::random_points(2000, 8);
  for (const double spacing : {1e-6, 0.1, 0.3, 10.0}) {
    const std::vector<int> kept = thin_points(points, spacing);
    EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
    const Points subset = points(Eigen::all, kept);
    for (int i = 0; i < subset.cols(); ++i)
      for (int j = 0; j < i; ++j) EXPECT_GE((subset.col(i) - subset.col(j)).norm(), spacing);
    for (const Vector3 x : points.colwise())
      EXPECT_LE((subset.colwise() - x).colwise().norm().minCoeff(), spacing);
  }
}

TEST(ThinPoints, KeepsOneOfDuplicatesAndNoneOfNothing) {
  EXPECT_EQ(thin_points(Points::Ones(3, 5), 0.1), std::vector<int>{0});
  EXPECT_TRUE(thin_points(Points(3, 0), 0.1).empty());
  EXPECT_THROW(thin_points(Points::Ones(3, 5), 0), InvalidInput);
}

}  // namespace
}  // namespace bespoke
