#include "bespoke/lattice/baked_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "bespoke/error.h"
#include "support/finite_differences.h"

namespace bespoke {
namespace {

// Two levels with random values; leaves that touch, leaves that do not.
Pyramid random_pyramid() {
  Pyramid pyramid;
  pyramid.origin = Vector3(0.25, -1, 2);
  pyramid.levels.push_back({0.5, {{-1, 0, 0}, {0, 0, 0}, {0, 0, 1}, {2, 2, 2}}, {}});
  pyramid.levels.push_back({0.25, {{-1, 0, 0}, {0, 0, 1}, {0, 0, 2}, {5, 5, 5}}, {}});
  std::mt19937 engine(5);
  std::uniform_real_distribution<float> value(-1, 1);
  for (PyramidLevel& level : pyramid.levels) {
    level.values.resize(3 * leaf_nodes * level.leaves.size());
    for (float& v : level.values) v = value(engine);
  }
  return pyramid;
}

Vector3 node_value(const PyramidLevel& level, int i, int j, int k) {
  for (std::size_t leaf = 0; leaf < level.leaves.size(); ++leaf)
    if (level.leaves[leaf] == LeafCoordinates{i >> 3, j >> 3, k >> 3}) {
      const auto node = static_cast<std::size_t>(((i & 7) * 8 + (j & 7)) * 8 + (k & 7));
      const float* v = &level.values[3 * (leaf * leaf_nodes + node)];
      return {v[0], v[1], v[2]};
    }
  return Vector3::Zero();
}

// The definition, without any index.
Vector3 sum_of_levels(const Pyramid& pyramid, const Vector3& x) {
  Vector3 sum = Vector3::Zero();
  for (const PyramidLevel& level : pyramid.levels) {
    const Vector3 lattice = (x - pyramid.origin) / level.voxel_size;
    const Vector3 lower = lattice.array().floor();
    const Vector3 f = lattice - lower;
    for (int corner = 0; corner < 8; ++corner) {
      const int dx = corner >> 2 & 1, dy = corner >> 1 & 1, dz = corner & 1;
      const double weight = (dx ? f.x() : 1 - f.x()) * (dy ? f.y() : 1 - f.y()) * (dz ? f.z() : 1 - f.z());
      sum += weight * node_value(level, static_cast<int>(lower.x()) + dx, static_cast<int>(lower.y()) + dy,
                                 static_cast<int>(lower.z()) + dz);
    }
  }
  return sum;
}

Points scattered_points(int count) {
  std::mt19937 engine(6);
  std::uniform_real_distribution<double> coordinate(-7, 15);
  Points x(3, count);
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = coordinate(engine);
  return x;
}

TEST(BakedMap, IsTheSumOfTrilinearLevels) {
  const Pyramid pyramid = random_pyramid();
  const BakedMap map(AffineMap{}, pyramid);
  const Points x = scattered_points(20000);
  const Points u = map.displacement(x);
  int nonzero = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vector3 expected = sum_of_levels(pyramid, x.col(i));
    ASSERT_NEAR((u.col(i) - expected).norm(), 0, 1e-12) << x.col(i).transpose();
    if (!expected.isZero(0)) ++nonzero;
  }
  EXPECT_GT(nonzero, 500);
}

TEST(BakedMap, TakesTheStoredValueAtANode) {
  const Pyramid pyramid = random_pyramid();
  const BakedMap map(AffineMap{}, pyramid);
  const double voxel_size = pyramid.levels[1].voxel_size;
  for (int i = -9; i < 10; ++i)
    for (int j = -2; j < 10; ++j)
      for (int k = -2; k < 26; k += 2) {
        const Vector3 x = pyramid.origin + voxel_size * Vector3(i, j, k);
        EXPECT_NEAR((map.displacement(x) - sum_of_levels(pyramid, x)).norm(), 0, 1e-12);
      }
}

TEST(BakedMap, GradientIsTheLimitOfDifferences) {
  const Pyramid pyramid = random_pyramid();
  const BakedMap map(AffineMap{}, pyramid);
  const Points x = scattered_points(3000);
  const Points gradient = map.displacement_gradient(x);
  const Points difference = test::finite_differences(map, x, 1e-5);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    // Differences across a face of two cells mix their gradients.
    const Vector3 lattice = (x.col(i) - pyramid.origin) / pyramid.levels[1].voxel_size;
    if (((lattice.array() - lattice.array().round()).abs() < 1e-3).any()) continue;
    ASSERT_NEAR((difference - gradient).middleCols<3>(3 * i).norm(), 0, 1e-8);
  }
}

TEST(BakedMap, IsContinuousAcrossEveryRim) {
  const Pyramid pyramid = random_pyramid();
  const BakedMap map(AffineMap{}, pyramid);
  // Values are at most √3 per level, so no gradient exceeds this.
  const double steepest = 2 * std::sqrt(3.0) * 3 * (1 / 0.5 + 1 / 0.25);
  const Points starts = scattered_points(40);
  const int steps = 20000;
  for (Eigen::Index i = 0; i + 1 < starts.cols(); ++i) {
    const Vector3 step = (starts.col(i + 1) - starts.col(i)) / steps;
    Points walk(3, steps + 1);
    for (int n = 0; n <= steps; ++n) walk.col(n) = starts.col(i) + n * step;
    const Points u = map.displacement(walk);
    for (int n = 0; n < steps; ++n)
      ASSERT_LE((u.col(n + 1) - u.col(n)).norm(), steepest * step.norm() + 1e-12);
  }
}

TEST(BakedMap, IsExactlyAffineOutsideItsSupport) {
  const BakedMap map(AffineMap{}, random_pyramid());
  const Support support = map.support();
  const Points x = scattered_points(20000);
  const Points u = map.displacement(x);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    bool inside = false;
    for (Eigen::Index c = 0; c < support.clouds[0].centers.cols(); ++c)
      inside |= (x.col(i) - support.clouds[0].centers.col(c)).norm() <= support.clouds[0].radius;
    if (!inside) {
      ASSERT_EQ(u.col(i), Vector3::Zero());
    }
  }
}

TEST(BakedMap, FarPointsAreAffineAndPointsThatAreNotFiniteHaveNoImage) {
  const BakedMap map(AffineMap{}, random_pyramid());
  EXPECT_EQ(Vector3(map.displacement(Vector3(1e300, 0, 0))), Vector3::Zero());
  EXPECT_TRUE(std::isnan(map.displacement(Vector3(std::nan(""), 0, 0))(0, 0)));
  EXPECT_TRUE(std::isnan(map.displacement(Vector3(0, INFINITY, 0))(1, 0)));
}

TEST(BakedMap, WithoutLevelsIsAffine) {
  const BakedMap map(AffineMap{}, Pyramid{});
  EXPECT_TRUE(map.displacement(Points::Random(3, 10)).isZero(0));
  EXPECT_TRUE(map.displacement_gradient(Points::Random(3, 10)).isZero(0));
  EXPECT_TRUE(map.support().clouds.empty());
}

TEST(BakedMap, RefusesAPyramidThatIsNotValid) {
  Pyramid pyramid = random_pyramid();
  pyramid.levels[1].leaves[0] = {-5, 0, 0};
  EXPECT_THROW(BakedMap(AffineMap{}, pyramid), InvalidInput);
}

}  // namespace
}  // namespace bespoke
