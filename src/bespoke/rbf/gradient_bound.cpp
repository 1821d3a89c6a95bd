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

constexpr double half_diagonal = 0.8660254037844387;  // of a unit cube

}  // namespace

/// Bounds one layer cube by cube.
class GradientBound::Search {
 public:
  Search(const RbfLayer& layer, double enough, Closeness closeness)
      : layer_(layer),
        enough_(enough),
        closeness_(closeness),
        sizes_(layer.coefficients.colwise().norm()),
        grid_(layer.centers, layer.lambda),
        evaluator_(layer.centers, layer.coefficients, layer.lambda, Wendland::c2) {}

  bool feels(const Vector3& low, double edge, const std::vector<char>& changed) const {
    bool result = false;
    grid_.for_each_within(low + Vector3::Constant(edge / 2), layer_.lambda + half_diagonal * edge,
                          [&](int j, double) { result = result || changed[std::size_t(j)]; });
    return result;
  }

  void look(const Vector3& low, double edge, Found& found, std::vector<int>& scratch) const {
    const double coarse = bound_from_sizes(low, edge);
    if (coarse <= enough_) {
      found.largest = std::max(found.largest, coarse);
      return;
    }
    // Cubes this small are left to the lattice.
    if (edge <= layer_.lambda / 4) return look_closely(low, edge, found, scratch);
    for (int octant = 0; octant < 8; ++octant)
      look(low + edge / 2 * Vector3(octant % 2, octant / 2 % 2, octant / 4), edge / 2, found, scratch);
  }

 private:
  /// Σ |cⱼ| max |φ'| / λ over the ball around the cube.
  double bound_from_sizes(const Vector3& low, double edge) const {
    const double radius = half_diagonal * edge;
    double sum = 0;
    grid_.for_each_within(low + Vector3::Constant(edge / 2), layer_.lambda + radius,
                          [&](int j, double squared) {
                            sum += sizes_[j] * steepest_beyond((std::sqrt(squared) - radius) / layer_.lambda);
                          });
    return sum / layer_.lambda;
  }

  /// The gradient's trilinear interpolant on a lattice of spacing δ takes its largest norm at a node, and
  /// misses the gradient by at most 3 δ²/8 Σ |cⱼ| ‖D³φ‖ / λ³. The lattice is refined until the second part is
  /// small.
  void look_closely(const Vector3& low, double edge, Found& found, std::vector<int>& scratch) const {
    const double curvature = curvature_from_sizes(low, edge);
    constexpr int coarsest = 2;
    constexpr int finest = 8;
    for (int intervals = coarsest;; intervals *= 2) {
      const double spacing = edge / intervals;
      const double remainder = 3 * spacing * spacing / 8 * curvature;
      const bool last = intervals == finest || remainder <= 0.1 * enough_;
      if (remainder >= enough_ && !last) continue;
      const double sampled = largest_at_nodes(low, spacing, intervals + 1, scratch);
      const bool steep = sampled > enough_ && closeness_ == Closeness::rough;
      if (sampled + remainder > enough_ && !last && !steep) continue;
      found.largest = std::max(found.largest, sampled + remainder);
      if (sampled + remainder > enough_)
        found.steep.push_back({low + Vector3::Constant(edge / 2), half_diagonal * edge,
                               sampled + std::min(remainder, 0.1 * sampled)});
      return;
    }
  }

  double curvature_from_sizes(const Vector3& low, double edge) const {
    const double radius = half_diagonal * edge;
    double sum = 0;
    grid_.for_each_within(
        low + Vector3::Constant(edge / 2), layer_.lambda + radius, [&](int j, double squared) {
          sum += sizes_[j] * third_derivative_beyond((std::sqrt(squared) - radius) / layer_.lambda);
        });
    return sum / (layer_.lambda * layer_.lambda * layer_.lambda);
  }

  double largest_at_nodes(const Vector3& low, double spacing, int nodes, std::vector<int>& scratch) const {
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
    evaluator_.evaluate(blocks.data(), blocks.size(), LayerEvaluator::Order::gradient, scratch);
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

  const RbfLayer& layer_;
  double enough_;
  Closeness closeness_;
  Eigen::RowVectorXd sizes_;
  PointGrid grid_;
  LayerEvaluator evaluator_;
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
    std::vector<int> scratch;
    for (std::size_t c = begin; c < end; ++c) {
      const Vector3 low = edge * Vector3(cells_[c][0], cells_[c][1], cells_[c][2]);
      const bool settled = found_[c].steep.empty() || closeness == Closeness::rough;
      if (!changed.empty() && settled && !search.feels(low, edge, changed)) continue;
      found_[c] = {};
      search.look(low, edge, found_[c], scratch);
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
