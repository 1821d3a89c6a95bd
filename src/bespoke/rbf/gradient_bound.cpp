#include "bespoke/rbf/gradient_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "bespoke/parallel.h"
#include "bespoke/rbf/kernels.h"
#include "bespoke/rbf/layer_evaluator.h"

namespace bespoke {
namespace {

/// max |φ'| over s ≥ `from`.
double steepest_beyond(double from) {
  constexpr double steepest_at = 0.25;
  const double s = std::max(from, steepest_at);
  return -s * WendlandC2::slope_over_s(s);
}

/// An upper bound of the norm of D³φ(|x|) over |x| = s ≥ `from`: the larger of 120 (1 − s)^{5/2} / √(1 + s),
/// taken between the radial and the tangential direction, and the purely radial |120 (1 − s)(1 − 2 s)|. The
/// first falls with s; so does the second except between 1/2 and its maximum 15 at 3/4.
double third_derivative_beyond(double from) {
  if (from >= 1) return 0;
  const double rest = 1 - std::max(from, 0.0);
  const double oblique = 120 * rest * rest * std::sqrt(rest / (2 - rest));
  const double radial = from < 0.75 ? 15 : 120 * rest * (1 - 2 * rest);
  return std::max(oblique, radial);
}

/// Spectral norm from above, at most 7 % too large: the 16th root of tr (GᵀG)⁸.
double norm_from_above(const Matrix3& gradient) {
  const double scale = gradient.cwiseAbs().maxCoeff();
  if (!(scale > 0)) return 0;
  Matrix3 power = (gradient / scale).transpose() * (gradient / scale);
  for (int doubling = 0; doubling < 3; ++doubling) power = (power * power).eval();
  return scale * std::sqrt(std::sqrt(std::sqrt(std::sqrt(power.trace()))));
}

using Cell = std::array<int, 3>;

/// Cells of edge `edge` (index · edge, from the origin) that come within λ of a centre.
std::vector<Cell> cells_in_reach(const RbfLayer& layer, double edge) {
  const auto index = [&](const Vector3& x) -> Cell {
    return {int(std::floor(x.x() / edge)), int(std::floor(x.y() / edge)), int(std::floor(x.z() / edge))};
  };
  std::vector<Cell> occupied;
  for (const Vector3 center : layer.centers.colwise()) occupied.push_back(index(center));
  std::sort(occupied.begin(), occupied.end());
  occupied.erase(std::unique(occupied.begin(), occupied.end()), occupied.end());
  const int reach = int(std::ceil(layer.lambda / edge));
  std::vector<Cell> cells;
  for (const Cell& cell : occupied)
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j)
        for (int k = -reach; k <= reach; ++k) {
          // Between two cells that do not touch lies one cell less than their indices differ.
          const auto gap = [](int offset) { return std::max(std::abs(offset) - 1, 0); };
          const int squared_gap = gap(i) * gap(i) + gap(j) * gap(j) + gap(k) * gap(k);
          if (squared_gap * edge * edge < layer.lambda * layer.lambda)
            cells.push_back({cell[0] + i, cell[1] + j, cell[2] + k});
        }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

using Bounds = LayerEvaluator::Bounds;

Bounds cube(const Vector3& low, double edge) {
  return {{low.x(), low.y(), low.z()}, {low.x() + edge, low.y() + edge, low.z() + edge}};
}

double distance(const Bounds& bounds, const LayerEvaluator::Center& center) {
  double squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double outside =
        std::max(std::max(bounds.low[axis] - center.z[axis], center.z[axis] - bounds.high[axis]), 0.0);
    squared += outside * outside;
  }
  return std::sqrt(squared);
}

}  // namespace

/// Bounds one layer cube by cube. Cubes get the positions of the centres within λ of them.
class GradientBound::Search {
 public:
  Search(const RbfLayer& layer, double enough, Closeness closeness)
      : lambda_(layer.lambda),
        enough_(enough),
        closeness_(closeness),
        evaluator_(layer.centers, layer.coefficients, layer.lambda, Wendland::c2) {
    for (const LayerEvaluator::Center& center : evaluator_.sorted_centers())
      sizes_.push_back(
          std::sqrt(center.c[0] * center.c[0] + center.c[1] * center.c[1] + center.c[2] * center.c[2]));
  }

  std::vector<int> centers_near(const Vector3& low, double edge) const {
    std::vector<int> near;
    evaluator_.collect(cube(low, edge), near);
    return near;
  }

  bool any(const std::vector<int>& near, const std::vector<char>& flags) const {
    return std::any_of(near.begin(), near.end(), [&](int position) {
      return flags[std::size_t(evaluator_.order()[std::size_t(position)])] != 0;
    });
  }

  void look(const Vector3& low, double edge, const std::vector<int>& near, Found& found) const {
    const double coarse = sum_over(near, cube(low, edge), steepest_beyond) / lambda_;
    if (coarse <= enough_) {
      found.largest = std::max(found.largest, coarse);
      return;
    }
    // Cubes this small are left to the lattice.
    if (edge <= lambda_ / 4) return look_closely(low, edge, near, found);
    std::vector<int> nearer;
    for (int octant = 0; octant < 8; ++octant) {
      const Vector3 part = low + edge / 2 * Vector3(octant % 2, octant / 2 % 2, octant / 4);
      evaluator_.narrow(cube(part, edge / 2), near, nearer);
      look(part, edge / 2, nearer, found);
    }
  }

 private:
  /// Σ |cⱼ| bound(sⱼ), sⱼ the least |x − zⱼ|/λ over the cube.
  template <class BoundBeyond>
  double sum_over(const std::vector<int>& near, const Bounds& bounds, const BoundBeyond& bound) const {
    double sum = 0;
    for (const int position : near)
      sum += sizes_[std::size_t(position)] *
             bound(distance(bounds, evaluator_.sorted_centers()[std::size_t(position)]) / lambda_);
    return sum;
  }

  /// The gradient's trilinear interpolant on a lattice of spacing δ takes its largest norm at a node, and
  /// misses the gradient by at most 3 δ²/8 Σ |cⱼ| ‖D³φ‖ / λ³. The lattice is refined until the second part is
  /// small.
  void look_closely(const Vector3& low, double edge, const std::vector<int>& near, Found& found) const {
    const double curvature =
        sum_over(near, cube(low, edge), third_derivative_beyond) / (lambda_ * lambda_ * lambda_);
    constexpr int coarsest = 2;
    constexpr int finest = 8;
    for (int intervals = coarsest;; intervals *= 2) {
      const double spacing = edge / intervals;
      const double remainder = 3 * spacing * spacing / 8 * curvature;
      const bool last = intervals == finest || remainder <= 0.1 * enough_;
      if (remainder >= enough_ && !last) continue;
      const double sampled = largest_at_nodes(low, spacing, intervals + 1, near);
      const bool steep = sampled > enough_ && closeness_ == Closeness::rough;
      if (sampled + remainder > enough_ && !last && !steep) continue;
      found.largest = std::max(found.largest, sampled + remainder);
      if (sampled + remainder > enough_)
        found.steep.push_back({low + Vector3::Constant(edge / 2), std::sqrt(3.0) / 2 * edge,
                               sampled + std::min(remainder, 0.1 * sampled)});
      return;
    }
  }

  double largest_at_nodes(const Vector3& low, double spacing, int nodes, const std::vector<int>& near) const {
    constexpr int lanes = LayerEvaluator::lanes;
    const int count = nodes * nodes * nodes;
    std::vector<LayerEvaluator::Block> blocks(std::size_t(count + lanes - 1) / lanes);
    for (int slot = 0; slot < int(blocks.size()) * lanes; ++slot) {
      const int node = std::min(slot, count - 1);
      const int index[3] = {node % nodes, node / nodes % nodes, node / (nodes * nodes)};
      for (int axis = 0; axis < 3; ++axis)
        blocks[std::size_t(slot / lanes)].x[axis][slot % lanes] = low[axis] + spacing * index[axis];
    }
    for (LayerEvaluator::Block& block : blocks) block.update_bounds();
    std::vector<int> nearby;
    evaluator_.evaluate_among(near, blocks.data(), blocks.size(), LayerEvaluator::Order::gradient, nearby);
    double largest = 0;
    for (int node = 0; node < count; ++node) {
      if (!blocks[std::size_t(node / lanes)].reached) continue;
      Matrix3 gradient;
      for (int i = 0; i < 9; ++i)
        gradient(i / 3, i % 3) = blocks[std::size_t(node / lanes)].gradient[i][node % lanes];
      // The Frobenius norm is never the smaller one.
      if (gradient.squaredNorm() > largest * largest) largest = std::max(largest, norm_from_above(gradient));
    }
    return largest;
  }

  double lambda_;
  double enough_;
  Closeness closeness_;
  LayerEvaluator evaluator_;
  std::vector<double> sizes_;  // |cⱼ| by position
};

void GradientBound::update(const RbfLayer& layer, double enough, Closeness closeness,
                           const std::vector<char>& changed) {
  const double edge = layer.lambda;
  if (changed.empty()) {
    cells_ = cells_in_reach(layer, edge);
    found_.assign(cells_.size(), {});
  }
  if (cells_.empty()) return;
  const Search search(layer, enough, closeness);
  parallel_for(cells_.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Vector3 low = edge * Vector3(cells_[c][0], cells_[c][1], cells_[c][2]);
      const bool is_final = found_[c].steep.empty() || closeness == Closeness::rough;
      const std::vector<int> near = search.centers_near(low, edge);
      if (!changed.empty() && is_final && !search.any(near, changed)) continue;
      found_[c] = {};
      search.look(low, edge, near, found_[c]);
    }
  });
}

double GradientBound::largest() const {
  double result = 0;
  for (const Found& found : found_) result = std::max(result, found.largest);
  // Far above the rounding errors of the sums.
  constexpr double margin = 1 + 1e-9;
  return margin * result;
}

std::vector<GradientBound::SteepPlace> GradientBound::steep_places() const {
  std::vector<SteepPlace> result;
  for (const Found& found : found_) result.insert(result.end(), found.steep.begin(), found.steep.end());
  return result;
}

}  // namespace bespoke
