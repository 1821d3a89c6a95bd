#include "bespoke/rbf/layer_evaluator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/instruction_set.h"
#include "bespoke/rbf/kernels.h"

namespace bespoke {
namespace {

using Block = LayerEvaluator::Block;
using Order = LayerEvaluator::Order;
constexpr int lanes = LayerEvaluator::lanes;

/// Eight doubles that the compiler keeps in one, two or four registers, by the instruction set.
using Lanes = double __attribute__((vector_size(lanes * sizeof(double))));

/// `centers`: six doubles each, place and coefficient.
struct Sum {
  const double* centers;
  const int* nearby;
  int count;
  double inverse_lambda;
};

template <class Function, Order order>
struct AddUp {
  [[gnu::always_inline]] static void run(const Sum& sum, Block& block) {
    Lanes x[3];
    Lanes value[3] = {};
    Lanes gradient[9] = {};
    for (int axis = 0; axis < 3; ++axis)
      for (int lane = 0; lane < lanes; ++lane) x[axis][lane] = block.x[axis][lane];
    const double squared_inverse = sum.inverse_lambda * sum.inverse_lambda;
    for (int k = 0; k < sum.count; ++k) {
      const double* center = sum.centers + 6 * std::ptrdiff_t(sum.nearby[k]);
      const Lanes dx = x[0] - center[0];
      const Lanes dy = x[1] - center[1];
      const Lanes dz = x[2] - center[2];
      const Lanes squared = (dx * dx + dy * dy + dz * dz) * squared_inverse;
      Lanes s;
      for (int lane = 0; lane < lanes; ++lane) s[lane] = __builtin_sqrt(squared[lane]);
      const Lanes q = s < 1 ? 1 - s : Lanes{};
      Lanes weight;
      if constexpr (order == Order::value) {
        Function::value(s, q, weight);
        for (int i = 0; i < 3; ++i) value[i] += weight * center[3 + i];
      } else {
        Function::value(s, q, weight);
        for (int i = 0; i < 3; ++i) value[i] += weight * center[3 + i];
        Function::slope_over_s(s, q, weight);
        weight *= squared_inverse;
        const Lanes direction[3] = {dx * weight, dy * weight, dz * weight};
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) gradient[3 * i + j] += center[3 + i] * direction[j];
      }
    }
    for (int lane = 0; lane < lanes; ++lane) {
      for (int i = 0; i < 3; ++i) block.value[i][lane] = value[i][lane];
      if constexpr (order == Order::gradient)
        for (int i = 0; i < 9; ++i) block.gradient[i][lane] = gradient[i][lane];
    }
  }
};

template <class Function>
void add_up(const Sum& sum, Block& block, Order order) {
  if (order == Order::value) return run_dispatched<AddUp<Function, Order::value>>(sum, block);
  run_dispatched<AddUp<Function, Order::gradient>>(sum, block);
}

using Bounds = LayerEvaluator::Bounds;

Bounds join(const Block* blocks, std::size_t count) {
  Bounds bounds = blocks[0].bounds;
  for (std::size_t b = 1; b < count; ++b)
    for (int axis = 0; axis < 3; ++axis) {
      bounds.low[axis] = std::min(bounds.low[axis], blocks[b].bounds.low[axis]);
      bounds.high[axis] = std::max(bounds.high[axis], blocks[b].bounds.high[axis]);
    }
  return bounds;
}

double extent(const Bounds& bounds) {
  double result = 0;
  for (int axis = 0; axis < 3; ++axis) result = std::max(result, bounds.high[axis] - bounds.low[axis]);
  return result;
}

template <class Center>
bool reaches(const Bounds& bounds, const Center& center, double squared_lambda) {
  double squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double outside =
        std::max(std::max(bounds.low[axis] - center.z[axis], center.z[axis] - bounds.high[axis]), 0.0);
    squared += outside * outside;
  }
  return squared < squared_lambda;
}

}  // namespace

LayerEvaluator::LayerEvaluator(const Points& centers, const Points& coefficients, double lambda,
                               Wendland function)
    : lambda_(lambda),
      function_(function),
      grid_(centers, lambda),
      places_(centers(Eigen::all, grid_.order()), lambda) {
  if (coefficients.cols() != centers.cols() || !coefficients.allFinite())
    throw InvalidInput("radial layer of " + std::to_string(centers.cols()) + " centres and " +
                       std::to_string(coefficients.cols()) +
                       " coefficients: the numbers must be equal and the values finite");
  sorted_.resize(grid_.order().size());
  for (std::size_t position = 0; position < sorted_.size(); ++position) {
    const int index = grid_.order()[position];
    for (int axis = 0; axis < 3; ++axis) {
      sorted_[position].z[axis] = centers(axis, index);
      sorted_[position].c[axis] = coefficients(axis, index);
    }
  }
  if (centers.cols() > 0) mark_reach(centers);
}

void LayerEvaluator::mark_reach(const Points& centers) {
  constexpr double max_cells = 1 << 22;
  const Vector3 low = centers.rowwise().minCoeff();
  const Vector3 high = centers.rowwise().maxCoeff();
  double edge = lambda_;
  const auto cells_along = [&] { return ((high - low).array() / edge).floor() + 3; };
  while (!(cells_along().prod() <= max_cells)) edge *= 1.25;
  // One cell of margin on every side, so that the neighbours of an occupied cell exist.
  reach_origin_ = low - Vector3::Constant(edge);
  reach_inverse_edge_ = 1 / edge;
  reach_cells_ = (cells_along() + 1).cast<int>();
  reach_.assign((static_cast<std::size_t>(reach_cells_.cast<double>().prod()) + 63) / 64, 0);
  for (const Center& center : sorted_) {
    Eigen::Array3i cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = static_cast<int>((center.z[axis] - reach_origin_[axis]) * reach_inverse_edge_);
    for (int k = std::max(cell.z() - 1, 0); k <= std::min(cell.z() + 1, reach_cells_.z() - 1); ++k)
      for (int j = std::max(cell.y() - 1, 0); j <= std::min(cell.y() + 1, reach_cells_.y() - 1); ++j)
        for (int i = std::max(cell.x() - 1, 0); i <= std::min(cell.x() + 1, reach_cells_.x() - 1); ++i) {
          const std::size_t bit = (std::size_t(k) * std::size_t(reach_cells_.y()) + std::size_t(j)) *
                                      std::size_t(reach_cells_.x()) +
                                  std::size_t(i);
          reach_[bit / 64] |= std::uint64_t{1} << (bit % 64);
        }
  }
}

bool LayerEvaluator::within_reach(const Bounds& bounds) const {
  int first[3];
  int last[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double from = (bounds.low[axis] - reach_origin_[axis]) * reach_inverse_edge_;
    const double to = (bounds.high[axis] - reach_origin_[axis]) * reach_inverse_edge_;
    // Negated so that NaN is out of reach.
    if (!(from < reach_cells_[axis]) || !(to >= 0)) return false;
    first[axis] = static_cast<int>(std::max(from, 0.0));
    last[axis] = static_cast<int>(std::min(to, double(reach_cells_[axis] - 1)));
  }
  // A look at very many cells costs more than it may save.
  constexpr double max_cells = 256;
  if (double(last[0] - first[0] + 1) * (last[1] - first[1] + 1) * (last[2] - first[2] + 1) > max_cells)
    return true;
  for (int k = first[2]; k <= last[2]; ++k)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int i = first[0]; i <= last[0]; ++i) {
        const std::size_t bit = (std::size_t(k) * std::size_t(reach_cells_.y()) + std::size_t(j)) *
                                    std::size_t(reach_cells_.x()) +
                                std::size_t(i);
        if (reach_[bit / 64] >> (bit % 64) & 1) return true;
      }
  return false;
}

void LayerEvaluator::collect(const Bounds& bounds, std::vector<int>& nearby) const {
  nearby.clear();
  const Vector3 low = Vector3(bounds.low[0], bounds.low[1], bounds.low[2]).array() - lambda_;
  const Vector3 high = Vector3(bounds.high[0], bounds.high[1], bounds.high[2]).array() + lambda_;
  thread_local std::vector<CenterPlaces::Range> ranges;
  ranges.clear();
  grid_.for_each_range(low, high, [](int begin, int end) { ranges.push_back({begin, end}); });
  places_.append_near(ranges, bounds.low, bounds.high, nearby);
}

void LayerEvaluator::narrow(const Bounds& bounds, const std::vector<int>& candidates,
                            std::vector<int>& nearby) const {
  const double squared_lambda = lambda_ * lambda_;
  nearby.resize(candidates.size());
  std::size_t kept = 0;
  for (const int position : candidates) {
    nearby[kept] = position;
    kept += reaches(bounds, sorted_[std::size_t(position)], squared_lambda);
  }
  nearby.resize(kept);
}

void LayerEvaluator::sum(Block& block, Order order, const int* nearby, int count) const {
  block.reached = count > 0;
  const Sum sum{sorted_.empty() ? nullptr : sorted_.front().z, nearby, count, 1 / lambda_};
  if (function_ == Wendland::c4) return add_up<WendlandC4>(sum, block, order);
  add_up<WendlandC2>(sum, block, order);
}

void LayerEvaluator::Block::update_bounds() {
  for (int axis = 0; axis < 3; ++axis) {
    bounds.low[axis] = *std::min_element(std::begin(x[axis]), std::end(x[axis]));
    bounds.high[axis] = *std::max_element(std::begin(x[axis]), std::end(x[axis]));
  }
}

void LayerEvaluator::evaluate(Block* blocks, std::size_t count, Order order, std::vector<int>& nearby) const {
  if (count == 0) return;
  const Bounds bounds = join(blocks, count);
  if (sorted_.empty() || !within_reach(bounds)) {
    for (std::size_t b = 0; b < count; ++b) blocks[b].reached = false;
    return;
  }
  // Groups no wider than λ share one list of candidates; wider ones would drag along too many.
  if (extent(bounds) <= lambda_) return evaluate_together(blocks, count, bounds, order, nearby);
  if (count == 1) return evaluate_lanes(*blocks, order, nearby);
  evaluate(blocks, count / 2, order, nearby);
  evaluate(blocks + count / 2, count - count / 2, order, nearby);
}

void LayerEvaluator::evaluate_together(Block* blocks, std::size_t count, const Bounds& bounds, Order order,
                                       std::vector<int>& nearby) const {
  collect(bounds, nearby);
  if (count == 1) return sum(*blocks, order, nearby.data(), int(nearby.size()));
  const std::vector<int> candidates = nearby;
  evaluate_among(candidates, blocks, count, order, nearby);
}

void LayerEvaluator::evaluate_among(const std::vector<int>& candidates, Block* blocks, std::size_t count,
                                    Order order, std::vector<int>& nearby) const {
  const CenterPlaces among = places_.subset(candidates);
  const std::vector<CenterPlaces::Range> all{{0, int(candidates.size())}};
  for (std::size_t b = 0; b < count; ++b) {
    nearby.clear();
    among.append_near(all, blocks[b].bounds.low, blocks[b].bounds.high, nearby);
    for (int& position : nearby) position = candidates[std::size_t(position)];
    sum(blocks[b], order, nearby.data(), int(nearby.size()));
  }
}

void LayerEvaluator::evaluate_lanes(Block& block, Order order, std::vector<int>& nearby) const {
  // Up to this width one list for all lanes is cheaper than one each.
  constexpr double widest_shared_list = 2;
  if (extent(block.bounds) <= widest_shared_list * lambda_) {
    collect(block.bounds, nearby);
    return sum(block, order, nearby.data(), int(nearby.size()));
  }
  block.reached = false;
  for (int lane = 0; lane < lanes; ++lane) {
    Block single;
    for (int axis = 0; axis < 3; ++axis)
      std::fill(std::begin(single.x[axis]), std::end(single.x[axis]), block.x[axis][lane]);
    single.update_bounds();
    if (!within_reach(single.bounds)) continue;
    collect(single.bounds, nearby);
    sum(single, order, nearby.data(), int(nearby.size()));
    if (!single.reached) continue;
    if (!block.reached) sum(block, order, nearby.data(), 0);
    block.reached = true;
    for (int i = 0; i < 3; ++i) block.value[i][lane] = single.value[i][0];
    if (order == Order::gradient)
      for (int i = 0; i < 9; ++i) block.gradient[i][lane] = single.gradient[i][0];
  }
}

}  // namespace bespoke
