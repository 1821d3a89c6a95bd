#include "bespoke/rbf/gradient_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "bespoke/parallel.h"
#include "bespoke/rbf/kernels.h"
#include "bespoke/rbf/layer_evaluator.h"
#include "bespoke/rbf/point_grid.h"

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
  return scale * std::pow(power.trace(), 1.0 / 16);
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

/// Bounds one layer cell by cell.
class CellBounds {
 public:
  explicit CellBounds(const RbfLayer& layer)
      : layer_(layer),
        sizes_(layer.coefficients.colwise().norm()),
        grid_(layer.centers, layer.lambda),
        evaluator_(layer.centers, layer.coefficients, layer.lambda, Wendland::c2) {}

  /// Σ |cⱼ| max |φ'| / λ over the ball around `center`.
  double coarse(const Vector3& center, double radius) const {
    double sum = 0;
    grid_.for_each_within(center, layer_.lambda + radius, [&](int j, double squared) {
      sum += sizes_[j] * steepest_beyond((std::sqrt(squared) - radius) / layer_.lambda);
    });
    return sum / layer_.lambda;
  }

  /// The gradient's trilinear interpolant on a lattice of spacing δ takes its largest norm at a node, and
  /// misses the gradient by at most 3 δ²/8 Σ |cⱼ| ‖D³φ‖ / λ³.
  double fine(const Vector3& low, double edge, std::vector<int>& scratch) const {
    double largest = 0;
    constexpr int parts = 2;
    for (int part = 0; part < parts * parts * parts; ++part) {
      const double part_edge = edge / parts;
      const Vector3 part_low =
          low + part_edge * Vector3(part % parts, part / parts % parts, part / (parts * parts));
      largest =
          std::max(largest, remainder(part_low, part_edge) + largest_at_nodes(part_low, part_edge, scratch));
    }
    return largest;
  }

 private:
  static constexpr int nodes = 3;  // along an edge of a part

  double remainder(const Vector3& low, double edge) const {
    const double spacing = edge / (nodes - 1);
    const double radius = std::sqrt(3.0) / 2 * edge;
    double sum = 0;
    grid_.for_each_within(
        low + Vector3::Constant(edge / 2), layer_.lambda + radius, [&](int j, double squared) {
          sum += sizes_[j] * third_derivative_beyond((std::sqrt(squared) - radius) / layer_.lambda);
        });
    return 3 * spacing * spacing / 8 * sum / (layer_.lambda * layer_.lambda * layer_.lambda);
  }

  double largest_at_nodes(const Vector3& low, double edge, std::vector<int>& scratch) const {
    constexpr int count = nodes * nodes * nodes;
    constexpr int lanes = LayerEvaluator::lanes;
    constexpr int blocks = (count + lanes - 1) / lanes;
    LayerEvaluator::Block block[blocks];
    for (int slot = 0; slot < blocks * lanes; ++slot) {
      const int node = std::min(slot, count - 1);
      const int index[3] = {node % nodes, node / nodes % nodes, node / (nodes * nodes)};
      for (int axis = 0; axis < 3; ++axis)
        block[slot / lanes].x[axis][slot % lanes] = low[axis] + edge * index[axis] / (nodes - 1);
    }
    evaluator_.evaluate(block, blocks, LayerEvaluator::Order::gradient, scratch);
    double largest = 0;
    for (int node = 0; node < count; ++node) {
      Matrix3 gradient;
      for (int i = 0; i < 9; ++i) gradient(i / 3, i % 3) = block[node / lanes].gradient[i][node % lanes];
      largest = std::max(largest, norm_from_above(gradient));
    }
    return largest;
  }

  const RbfLayer& layer_;
  Eigen::RowVectorXd sizes_;
  PointGrid grid_;
  LayerEvaluator evaluator_;
};

}  // namespace

double gradient_bound(const RbfLayer& layer, double enough) {
  if (layer.centers.cols() == 0) return 0;
  const double edge = layer.lambda / 2;
  const std::vector<Cell> cells = cells_in_reach(layer, edge);
  const CellBounds bounds(layer);
  const auto largest = [&](std::size_t begin, std::size_t end) {
    double result = 0;
    std::vector<int> scratch;
    for (std::size_t c = begin; c < end; ++c) {
      const Vector3 low = edge * Vector3(cells[c][0], cells[c][1], cells[c][2]);
      double bound = bounds.coarse(low + Vector3::Constant(edge / 2), std::sqrt(3.0) / 2 * edge);
      if (!(bound <= enough)) bound = std::min(bound, bounds.fine(low, edge, scratch));
      result = std::max(result, bound);
    }
    return result;
  };
  // Far above the rounding errors of the sums.
  constexpr double margin = 1 + 1e-9;
  return margin *
         parallel_reduce(cells.size(), 32, 0.0, largest, [](double a, double b) { return std::max(a, b); });
}

}  // namespace bespoke
