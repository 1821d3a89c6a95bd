#include "bespoke/elastic/detail/element_distortion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "support/instruction_sets.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

NestedElements two_levels() {
  std::vector<std::vector<LatticeCoordinates>> nodes(2);
  for (int i = 0; i <= 3; ++i)
    for (int j = 0; j <= 3; ++j)
      for (int k = 0; k <= 3; ++k) nodes[0].push_back({i, j, k});
  nodes[1] = {{3, 3, 3}, {2, 3, 4}};
  return {{Vector3::Zero(), 0.25}, nodes};
}

std::vector<Points> zeros(const NestedElements& elements) {
  std::vector<Points> values;
  for (const ElementLevel& level : elements.levels())
    values.push_back(Points::Zero(3, static_cast<Eigen::Index>(level.points.size())));
  return values;
}

/// (F − I) x at all points.
std::vector<Points> linear_values(const NestedElements& elements, const Matrix3& f) {
  std::vector<Points> values = zeros(elements);
  for (std::size_t k = 0; k < values.size(); ++k)
    for (Eigen::Index p = 0; p < values[k].cols(); ++p)
      values[k].col(p) = (f - Matrix3::Identity()) *
                         elements.lattice(k)(elements.levels()[k].points[static_cast<std::size_t>(p)]);
  return values;
}

double volume(const NestedElements& elements) {
  double sum = 0;
  for (const ElementLevel& level : elements.levels())
    sum += static_cast<double>(level.finest.size()) * std::pow(level.voxel_size, 3);
  return sum;
}

Distortion added(const NestedElements& elements, const std::vector<Points>& values,
                 const DistortionBounds& bounds, std::vector<Points>& gradients) {
  std::vector<double> scratch;
  return add_distortion(elements, values, bounds, gradients, scratch);
}

Distortion of(const NestedElements& elements, const std::vector<Points>& values) {
  std::vector<Points> unused = zeros(elements);
  return added(elements, values, {}, unused);
}

/// So wide that the barriers vanish.
constexpr DistortionBounds no_bounds{1e-12, 1e12};

TEST(Distortion, VanishesForRotationsAlone) {
  const NestedElements elements = two_levels();
  EXPECT_EQ(of(elements, zeros(elements)).energy,
            of(elements, linear_values(elements, Matrix3::Identity())).energy);
  std::vector<Points> gradients = zeros(elements);
  const Distortion turned =
      added(elements, linear_values(elements, test::random_rotation(1)), no_bounds, gradients);
  EXPECT_NEAR(turned.energy, 0, 1e-12);
  EXPECT_NEAR(turned.min_determinant, 1, 1e-12);
}

TEST(Distortion, IsTheSymmetricDirichletEnergyOfAnAffineMap) {
  const NestedElements elements = two_levels();
  Matrix3 f;
  f << 1.2, 0.3, 0, -0.1, 0.8, 0.2, 0.1, 0, 1.5;
  std::vector<Points> gradients = zeros(elements);
  const Distortion found = added(elements, linear_values(elements, f), no_bounds, gradients);
  EXPECT_NEAR(found.energy, volume(elements) * ((f.squaredNorm() + f.inverse().squaredNorm()) / 2 - 3), 1e-9);
  EXPECT_NEAR(found.min_determinant, f.determinant(), 1e-12);
}

TEST(Distortion, CountsByTheWeightsOfCells) {
  NestedElements elements = two_levels();
  const std::vector<Points> values = linear_values(elements, Vector3(1.2, 1, 0.9).asDiagonal());
  const double energy = of(elements, values).energy;
  std::vector<std::vector<double>> weights;
  double heavy = 0;
  for (const ElementLevel& level : elements.levels()) {
    weights.emplace_back(level.finest.size(), 1.0);
    weights.back().front() = 3;
    heavy += std::pow(level.voxel_size, 3);
  }
  elements.weigh(std::move(weights));
  EXPECT_NEAR(of(elements, values).energy, energy * (1 + 2 * heavy / volume(elements)), 1e-12);
}

TEST(Distortion, TellsTheCellsThatAreBeyondABound) {
  const NestedElements elements = two_levels();
  std::vector<Points> values = zeros(elements);
  values[1](0, 0) = 10 * elements.levels()[1].voxel_size;
  const Distortion found = of(elements, values);
  ASSERT_TRUE(std::isinf(found.energy));
  const ElementLevel& level = elements.levels()[1];
  for (std::size_t number = 0; number < level.finest.size(); ++number) {
    const std::array<int, 8>& corners = level.corners[static_cast<std::size_t>(level.finest[number])];
    EXPECT_EQ(std::isinf(found.stiffness[1][number]),
              std::find(corners.begin(), corners.end(), 0) != corners.end());
  }
  for (const double stiffness : found.stiffness[0]) EXPECT_TRUE(std::isfinite(stiffness));
}

TEST(Distortion, IsInfiniteWhereAVolumeOrALengthIsBeyondItsBound) {
  const NestedElements elements = two_levels();
  EXPECT_TRUE(std::isinf(of(elements, linear_values(elements, Vector3(1, 1, -1).asDiagonal())).energy));
  EXPECT_TRUE(std::isinf(of(elements, linear_values(elements, Vector3(1, 1, 0.019).asDiagonal())).energy));
  EXPECT_TRUE(
      std::isfinite(of(elements, linear_values(elements, Vector3(1, 0.25, 0.11).asDiagonal())).energy));
  EXPECT_TRUE(std::isinf(of(elements, linear_values(elements, Vector3(4, 1, 0.09).asDiagonal())).energy));
}

TEST(Distortion, IsInfiniteWhereACellFoldsBetweenItsCorners) {
  // Opposite faces turned against each other by 130 degrees: positive at all corners, not at the centre.
  const NestedElements elements({Vector3::Zero(), 1}, {{{0, 0, 0}}});
  std::vector<Points> values = zeros(elements);
  const auto turn_above = [&](double degrees) {
    const Matrix3 turn = Eigen::AngleAxisd(degrees * EIGEN_PI / 180, Vector3::UnitZ()).toRotationMatrix();
    for (Eigen::Index p = 0; p < values[0].cols(); ++p) {
      const Vector3 x = as_vector(elements.levels()[0].points[static_cast<std::size_t>(p)]);
      if (x.z() > 0.5) values[0].col(p) = turn * x - x;
    }
  };
  turn_above(20);
  EXPECT_TRUE(std::isfinite(of(elements, values).energy));
  turn_above(175);
  EXPECT_TRUE(std::isinf(of(elements, values).energy));
}

TEST(Distortion, GradientAgreesWithFiniteDifferences) {
  const NestedElements elements = two_levels();
  std::vector<Points> values = zeros(elements), direction = zeros(elements);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double size = 0.12 * elements.levels()[k].voxel_size;
    values[k] = size * test::random_points(values[k].cols(), 3 + static_cast<unsigned>(k));
    direction[k] = test::random_points(values[k].cols(), 9 + static_cast<unsigned>(k));
  }
  // Bounds that matter: the barriers have a gradient too.
  const DistortionBounds bounds{0.2, 8};
  const auto energy = [&](double t) {
    std::vector<Points> moved = values, unused = zeros(elements);
    for (std::size_t k = 0; k < moved.size(); ++k) moved[k] += t * direction[k];
    return added(elements, moved, bounds, unused).energy;
  };
  std::vector<Points> gradients = zeros(elements);
  ASSERT_TRUE(std::isfinite(added(elements, values, bounds, gradients).energy));
  double slope = 0;
  for (std::size_t k = 0; k < values.size(); ++k) slope += gradients[k].cwiseProduct(direction[k]).sum();
  constexpr double step = 1e-5;
  EXPECT_NEAR(slope, (energy(step) - energy(-step)) / (2 * step), 1e-6 * std::abs(slope));
}

TEST(Distortion, HasTheSameBitsWithEveryInstructionSet) {
  const NestedElements elements = two_levels();
  std::vector<Points> values = zeros(elements);
  for (Points& level : values) level = 0.03 * test::random_points(level.cols(), 5);
  test::expect_same_bits_with_every_instruction_set([&] {
    std::vector<Points> gradients = zeros(elements);
    std::vector<double> result{added(elements, values, {}, gradients).energy};
    for (const Points& level : gradients)
      result.insert(result.end(), level.data(), level.data() + level.size());
    return result;
  });
}

}  // namespace
}  // namespace bespoke
