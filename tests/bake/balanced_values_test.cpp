#include "bespoke/bake/pyramid/balanced_values.h"

#include <gmock/gmock.h>

#include <functional>
#include <vector>

#include "bespoke/bake/pyramid/sampled_levels.h"
#include "bespoke/mapping/elastic_map.h"

namespace bespoke {
namespace {

using Function = std::function<Vector3(const Vector3&)>;

constexpr double voxel = 0.25;

LeafValues sampled(const Function& u, const LeafCoordinates& leaf) {
  LeafValues values;
  for (int node = 0; node < leaf_nodes; ++node) {
    const Vector3 value = u(voxel * as_vector(moved(first_node(leaf), place_of_number(node))));
    for (int c = 0; c < 3; ++c) values[static_cast<std::size_t>(3 * node + c)] = static_cast<float>(value[c]);
  }
  return values;
}

// Of the leaf at the origin, with the six across its faces or without those whose number is left out.
std::shared_ptr<const LeafValues> balanced(const Function& u, int left_out = -1) {
  const LeafValues middle = sampled(u, {0, 0, 0});
  std::array<LeafValues, 6> beside;
  LeafSurroundings around{&middle, {}};
  for (int side = 0; side < 6; ++side) {
    LeafCoordinates leaf{};
    leaf[static_cast<std::size_t>(side / 2)] = side % 2 ? 1 : -1;
    beside[static_cast<std::size_t>(side)] = sampled(u, leaf);
    if (side != left_out)
      around.beside[static_cast<std::size_t>(side / 2)][static_cast<std::size_t>(side % 2)] =
          &beside[static_cast<std::size_t>(side)];
  }
  return balanced_values(around);
}

Vector3 value_at(const LeafValues& values, const LatticeCoordinates& place) {
  return Eigen::Map<const Eigen::Vector3f>(&values[static_cast<std::size_t>(3 * number_of_place(place))])
      .cast<double>();
}

// Trilinear, at the middle of the cell at a place, of an edge of it or of a face: half a cell along each axis
// of the corner's step.
Vector3 value_between(const LeafValues& values, const LatticeCoordinates& place, int corner) {
  Vector3 sum = Vector3::Zero();
  for (int other = 0; other < 8; ++other) sum += value_at(values, moved(place, corner_step(other & corner)));
  return sum / 8;
}

TEST(BalancedValues, LeaveAffineFunctionsAsTheyAre) {
  const Function affine = [](const Vector3& x) { return Vector3(1 + x[0], 2 * x[1] - x[2], 3 - x[2]); };
  const LeafValues as_sampled = sampled(affine, {0, 0, 0});
  EXPECT_EQ(*balanced(affine), as_sampled);
}

TEST(BalancedValues, ErrAsFarToEitherSideAndHalfAsFarWhereAFunctionBendsOneWay) {
  const Vector3 bend(1, 2, 0.5);  // second derivatives along the axes
  const Function round = [&](const Vector3& x) {
    return Vector3(x.cwiseAbs2().dot(bend) / 2, -x.cwiseAbs2().dot(bend) / 2, 7);
  };
  const auto values = balanced(round);
  const double most = voxel * voxel * bend.sum() / 16;  // sampled nodes: 0 to twice that
  for (const LatticeCoordinates& place : {LatticeCoordinates{0, 0, 0}, {3, 4, 5}, {6, 0, 6}}) {
    const Vector3 at = voxel * as_vector(place);
    EXPECT_NEAR(value_at(*values, place)[0] - round(at)[0], -most, 1e-6);
    const Vector3 middle = at + Vector3::Constant(voxel / 2);
    EXPECT_NEAR(value_between(*values, place, 7)[0] - round(middle)[0], most, 1e-6);
    EXPECT_NEAR(value_between(*values, place, 7)[1] - round(middle)[1], -most, 1e-6);
    EXPECT_NEAR(value_between(*values, place, 7)[2], 7, 1e-6);
  }
}

// What bends one way along an axis and the other way along another errs no farther than before.
TEST(BalancedValues, OfHarmonicFunctionsAreTheirOwn) {
  const Function saddle = [](const Vector3& x) {
    return Vector3(x[0] * x[0] - x[1] * x[1], x[0] * x[1], x[1] * x[1] - x[2] * x[2]);
  };
  const auto values = balanced(saddle);
  const LeafValues as_sampled = sampled(saddle, {0, 0, 0});
  for (std::size_t k = 0; k < values->size(); ++k) ASSERT_NEAR((*values)[k], as_sampled[k], 1e-6);
}

TEST(BalancedValues, StayZeroWhereTheFunctionIs) {
  const Function half = [](const Vector3& x) {
    const double beyond = std::max(0.0, x[0] - 4 * voxel);
    return Vector3(beyond * beyond, 0, 0);
  };
  const auto values = balanced(half);
  for (int i = 0; i <= 4; ++i) EXPECT_EQ(value_at(*values, {i, 2, 2}), Vector3::Zero()) << i;
  EXPECT_NE(value_at(*values, {5, 2, 2}), half(voxel * Vector3(5, 2, 2)));
}

TEST(BalancedValues, GoWithoutTheAxisAlongWhichALeafIsMissing) {
  const Function along_y = [](const Vector3& x) { return Vector3(x[1] * x[1], 1, 1); };
  const Function along_z = [](const Vector3& x) { return Vector3(x[2] * x[2], 1, 1); };
  constexpr int upper_y = 3;
  const auto bent_y = balanced(along_y, upper_y), bent_z = balanced(along_z, upper_y);
  EXPECT_EQ(value_at(*bent_y, {2, 7, 2}), along_y(voxel * Vector3(2, 7, 2)));
  EXPECT_LT(value_at(*bent_y, {2, 6, 2})[0], along_y(voxel * Vector3(2, 6, 2))[0]);
  EXPECT_LT(value_at(*bent_z, {2, 7, 2})[0], along_z(voxel * Vector3(2, 7, 2))[0]);
}

TEST(SampledLevels, HaveTheSameValuesInWhateverOrderLeavesCome) {
  const Function wave = [](const Vector3& x) {
    return Vector3(std::sin(x[0] + x[1]), std::cos(x[2]), std::sin(2 * x[1]));
  };
  const std::vector<LeafCoordinates> leaves = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  const auto filled = [&](const std::vector<std::vector<LeafCoordinates>>& batches) {
    SampledLevels levels({Vector3::Zero(), voxel});
    for (const std::vector<LeafCoordinates>& batch : batches) {
      std::vector<float> samples;
      for (const LeafCoordinates& leaf : batch) {
        const LeafValues values = sampled(wave, leaf);
        samples.insert(samples.end(), values.begin(), values.end());
      }
      levels.append(0, batch, samples, NodeValues::balanced);
    }
    return levels;
  };
  const SampledLevels at_once = filled({leaves});
  const SampledLevels one_by_one = filled({{leaves[3]}, {leaves[1]}, {leaves[0]}, {leaves[4]}, {leaves[2]}});
  for (const LeafCoordinates& leaf : leaves) {
    NodeBlock first, second;
    at_once.sum_at(0, leaf, first);
    one_by_one.sum_at(0, leaf, second);
    EXPECT_EQ(first, second);
  }
}

}  // namespace
}  // namespace bespoke
