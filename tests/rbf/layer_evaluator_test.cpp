#include "bespoke/rbf/layer_evaluator.h"

#include <gtest/gtest.h>

#include <limits>

#include "bespoke/error.h"
#include "support/instruction_sets.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

using Block = LayerEvaluator::Block;
using Order = LayerEvaluator::Order;
constexpr int lanes = LayerEvaluator::lanes;

/// x: a multiple of `lanes` columns.
std::vector<Block> blocks_of(const Points& x) {
  std::vector<Block> blocks(static_cast<std::size_t>(x.cols() / lanes));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (int lane = 0; lane < lanes; ++lane)
      for (int axis = 0; axis < 3; ++axis)
        blocks[b].x[axis][lane] = x(axis, static_cast<Eigen::Index>(b) * lanes + lane);
    blocks[b].update_bounds();
  }
  return blocks;
}

/// Groups of `lanes` points, the points of a group at most 2·spread from each other along an axis.
Points groups(int count, double spread) {
  Points x = spread * test::random_points(count * lanes, 3);
  const Points middles = 1.3 * test::random_points(count, 4);
  for (int i = 0; i < count; ++i) x.middleCols(i * lanes, lanes).colwise() += middles.col(i);
  return x;
}

LayerEvaluator layer(Wendland function) {
  return {test::random_points(200, 1), test::random_points(200, 2), 0.4, function};
}

std::vector<double> numbers(const LayerEvaluator& layer, std::vector<Block> blocks, Order order) {
  std::vector<int> nearby;
  layer.evaluate(blocks.data(), blocks.size(), order, nearby);
  std::vector<double> result;
  for (const Block& block : blocks) {
    result.push_back(block.reached);
    if (!block.reached) continue;
    for (const auto& component : block.value) result.insert(result.end(), component, component + lanes);
    if (order == Order::value) continue;
    for (const auto& component : block.gradient) result.insert(result.end(), component, component + lanes);
  }
  return result;
}

TEST(LayerEvaluator, GivesTheSameBitsWithEveryInstructionSet) {
  for (const Wendland function : {Wendland::c2, Wendland::c4})
    for (const Order order : {Order::value, Order::gradient})
      for (const double spread : {0.05, 0.3, 3.0})
        test::expect_same_bits_with_every_instruction_set(
            [&] { return numbers(layer(function), blocks_of(groups(50, spread)), order); });
}

TEST(LayerEvaluator, RefusesUnusableLayers) {
  const Points centers = test::random_points(4, 35), coefficients = test::random_points(4, 36);
  EXPECT_THROW(LayerEvaluator(centers, coefficients.leftCols(3), 1, Wendland::c2), InvalidInput);
  EXPECT_THROW(LayerEvaluator(centers, coefficients, 0, Wendland::c2), InvalidInput);
  Points broken = coefficients;
  broken(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(LayerEvaluator(centers, broken, 1, Wendland::c2), InvalidInput);
}

}  // namespace
}  // namespace bespoke
