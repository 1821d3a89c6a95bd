#include "bespoke/rbf/layer_stack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bespoke/parallel.h"
#include "bespoke/rbf/detail/spatial_order.h"

namespace bespoke {
namespace {

using Block = LayerEvaluator::Block;
using Order = LayerEvaluator::Order;
constexpr int lanes = LayerEvaluator::lanes;

/// What a stack has summed for the points of one block so far.
struct Total {
  double value[3][lanes] = {};
  double gradient[9][lanes] = {};  // of y − x
};

void add_value(const Block& block, Total& total) {
  for (int i = 0; i < 3; ++i)
    for (int lane = 0; lane < lanes; ++lane) total.value[i][lane] += block.value[i][lane];
}

/// (I + G)(I + J) − I for composed layers; G + J for summed ones.
void add_gradient(const Block& block, Stacking stacking, Total& total) {
  Total before = total;
  for (int i = 0; i < 9; ++i)
    for (int lane = 0; lane < lanes; ++lane) total.gradient[i][lane] += block.gradient[i][lane];
  if (stacking == Stacking::summed) return;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k)
        for (int lane = 0; lane < lanes; ++lane)
          total.gradient[3 * i + j][lane] +=
              block.gradient[3 * i + k][lane] * before.gradient[3 * k + j][lane];
}

void move(Block& block) {
  for (int axis = 0; axis < 3; ++axis)
    for (int lane = 0; lane < lanes; ++lane) block.x[axis][lane] += block.value[axis][lane];
  block.update_bounds();
}

}  // namespace

LayerStack::LayerStack(std::vector<LayerEvaluator> layers, Stacking stacking)
    : layers_(std::move(layers)), stacking_(stacking) {}

Points LayerStack::displacement(const Points& x) const { return evaluate(x, Order::value); }

Points LayerStack::gradient(const Points& x) const { return evaluate(x, Order::gradient); }

Points LayerStack::evaluate(const Points& x, Order order) const {
  const std::vector<int> places = spatial_order(x);
  Points result(3, order == Order::value ? x.cols() : 3 * x.cols());
  constexpr std::size_t grain = 64 * lanes;
  parallel_for(places.size(), grain, [&](std::size_t begin, std::size_t end) {
    const std::size_t block_count = (end - begin + lanes - 1) / lanes;
    std::vector<Block> blocks(block_count);
    std::vector<Total> totals(block_count);
    std::vector<int> nearby;
    // The last block repeats the last point.
    const auto place = [&](std::size_t block, int lane) {
      return places[std::min(begin + block * lanes + std::size_t(lane), end - 1)];
    };
    for (std::size_t b = 0; b < block_count; ++b) {
      for (int lane = 0; lane < lanes; ++lane)
        for (int axis = 0; axis < 3; ++axis) {
          // NaN would hide the other points of the block; an infinite point is out of every reach.
          const double coordinate = x(axis, place(b, lane));
          blocks[b].x[axis][lane] =
              std::isnan(coordinate) ? std::numeric_limits<double>::infinity() : coordinate;
        }
      blocks[b].update_bounds();
    }
    for (const LayerEvaluator& layer : layers_) {
      layer.evaluate(blocks.data(), block_count, order, nearby);
      for (std::size_t b = 0; b < block_count; ++b) {
        if (!blocks[b].reached) continue;
        add_value(blocks[b], totals[b]);
        if (order == Order::gradient) add_gradient(blocks[b], stacking_, totals[b]);
        if (stacking_ == Stacking::composed) move(blocks[b]);
      }
    }
    for (std::size_t b = 0; b < block_count; ++b)
      for (int lane = 0; lane < lanes; ++lane) {
        const Eigen::Index index = place(b, lane);
        const double undefined = x.col(index).hasNaN() ? std::numeric_limits<double>::quiet_NaN() : 0;
        if (order == Order::value)
          for (int i = 0; i < 3; ++i) result(i, index) = totals[b].value[i][lane] + undefined;
        else
          for (int i = 0; i < 9; ++i)
            result(i / 3, 3 * index + i % 3) = totals[b].gradient[i][lane] + undefined;
      }
  });
  return result;
}

}  // namespace bespoke
