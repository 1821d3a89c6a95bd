#include "bespoke/elastic/finite_elements.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <utility>

#include "bespoke/elastic/detail/element_distortion.h"
#include "bespoke/elastic/detail/nested_elements.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/rigid/affine_alignment.h"
#include "bespoke/rigid/similarity_alignment.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

struct VertexTerm {
  std::vector<ElementPlace> places;  // per level; the last is the finest cell that holds it
  Vector3 target;                    // of u
  double weight;
};

/// Distortion and data as a function of the coefficients.
class LatticeObjective {
 public:
  LatticeObjective(const NestedElements& elements, std::vector<VertexTerm> terms)
      : elements_(elements), terms_(std::move(terms)) {}

  double operator()(const Points& coefficients, Points& gradient) {
    std::vector<Points> values = elements_.values(coefficients), gradients(values.size());
    for (std::size_t k = 0; k < values.size(); ++k) gradients[k].setZero(3, values[k].cols());
    const Distortion distortion = add_distortion(elements_, values, gradients);
    ++evaluations;
    if (!std::isfinite(distortion.energy)) return distortion.energy;
    min_determinant = distortion.min_determinant;
    double data = 0;
    for (const VertexTerm& term : terms_) {
      const ElementPlace& place = term.places.back();
      const auto level = static_cast<std::size_t>(place.level);
      const Vector3 off = value_at(values[level], place) - term.target;
      data += term.weight * off.squaredNorm() / 2;
      for (std::size_t corner = 0; corner < 8; ++corner)
        gradients[level].col(place.corners[corner]) += term.weight * place.weights[corner] * off;
    }
    gradient = elements_.restricted(gradients);
    return distortion.energy + data;
  }

  Eigen::VectorXd inverse_diagonal(const Points& coefficients) const {
    std::vector<std::vector<double>> diagonal = distortion_diagonal(elements_, elements_.values(coefficients));
    for (const VertexTerm& term : terms_)
      for (const ElementPlace& place : term.places)
        for (std::size_t corner = 0; corner < 8; ++corner)
          diagonal[static_cast<std::size_t>(place.level)][static_cast<std::size_t>(place.corners[corner])] +=
              term.weight * place.weights[corner] * place.weights[corner];
    Eigen::VectorXd inverse(static_cast<Eigen::Index>(elements_.unknowns()));
    for (std::size_t k = 0; k < elements_.levels().size(); ++k) {
      const ElementLevel& level = elements_.levels()[k];
      for (std::size_t n = 0; n < level.nodes.size(); ++n)
        inverse[static_cast<Eigen::Index>(level.first_unknown + n)] =
            1 / diagonal[k][static_cast<std::size_t>(level.point_of_node[n])];
    }
    return inverse;
  }

  std::vector<double> residuals(const Points& coefficients) const {
    const std::vector<Points> values = elements_.values(coefficients);
    std::vector<double> result;
    for (const VertexTerm& term : terms_) {
      const ElementPlace& place = term.places.back();
      result.push_back((value_at(values[static_cast<std::size_t>(place.level)], place) - term.target).norm());
    }
    return result;
  }

  void set_weight(double weight) {
    for (VertexTerm& term : terms_) term.weight = weight;
  }

  int evaluations = 0;
  double min_determinant = 0;

 private:
  static Vector3 value_at(const Points& values, const ElementPlace& place) {
    Vector3 value = Vector3::Zero();
    for (std::size_t corner = 0; corner < 8; ++corner)
      value += place.weights[corner] * values.col(place.corners[corner]);
    return value;
  }

  const NestedElements& elements_;
  std::vector<VertexTerm> terms_;
};

double dot(const Points& a, const Points& b) { return a.cwiseProduct(b).sum(); }

/// Limited-memory BFGS with a diagonal start. Never accepts a point of infinite energy.
int minimise(LatticeObjective& objective, Points& x, int max_iterations, double relative_decrease) {
  constexpr std::size_t memory = 6;
  Points gradient;
  double energy = objective(x, gradient);
  Eigen::VectorXd scale = objective.inverse_diagonal(x);
  std::deque<Points> steps, changes;
  std::deque<double> products;
  int iteration = 0;
  Points trial_gradient;
  const bool verbose = std::getenv("FE_VERBOSE") != nullptr;
  int slow = 0;
  for (; iteration < max_iterations; ++iteration) {
    Points direction = gradient;
    std::vector<double> alphas(steps.size());
    for (std::size_t i = steps.size(); i-- > 0;) {
      alphas[i] = dot(steps[i], direction) / products[i];
      direction -= alphas[i] * changes[i];
    }
    double gamma = 1;
    if (!steps.empty()) {
      const Points scaled = changes.back() * scale.asDiagonal();
      gamma = products.back() / dot(changes.back(), scaled);
    }
    direction = gamma * (direction * scale.asDiagonal());
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const double beta = dot(changes[i], direction) / products[i];
      direction += (alphas[i] - beta) * steps[i];
    }
    const double slope = -dot(gradient, direction);
    double t = steps.empty() ? 0.3 : 1, trial = 0;
    Points next;
    int halvings = 0;
    for (;; t /= 2, ++halvings) {
      next = x - t * direction;
      trial = objective(next, trial_gradient);
      if (trial <= energy + 1e-4 * t * slope) break;
      if (halvings > 20) break;
    }
    if (!(trial < energy)) break;
    Points step = next - x, change = trial_gradient - gradient;
    const double product = dot(step, change);
    if (product > 0) {
      steps.push_back(std::move(step));
      changes.push_back(std::move(change));
      products.push_back(product);
      if (steps.size() > memory) steps.pop_front(), changes.pop_front(), products.pop_front();
    }
    if (verbose)
      std::fprintf(stderr, "   it %d energy %.6g slope %.3g t %g min det %.4g\n", iteration, trial, slope, t,
                   objective.min_determinant);
    const double decrease = energy - trial;
    x = std::move(next);
    energy = trial;
    std::swap(gradient, trial_gradient);
    slow = decrease < relative_decrease * energy ? slow + 1 : 0;
    if (slow >= 2) break;
  }
  return iteration;
}

std::vector<LatticeCoordinates> band_nodes(const Points& sources, const Faces* faces, const Lattice& lattice,
                                           double lambda) {
  Box box = Box();
  for (const auto& x : sources.colwise()) box.extend(Vector3(x));
  const LatticeCoordinates low = lattice.cell_of(box.min() - Vector3::Constant(lambda)),
                           high = lattice.cell_of(box.max() + Vector3::Constant(lambda));
  const ClosestPointTree tree(TriangleMesh{sources, *faces});
  std::vector<LatticeCoordinates> nodes;
  for (int i = low[0]; i <= high[0] + 1; ++i)
    for (int j = low[1]; j <= high[1] + 1; ++j)
      for (int k = low[2]; k <= high[2] + 1; ++k)
        if (tree.closest(lattice({i, j, k}), {.max_distance = lambda})) nodes.push_back({i, j, k});
  return nodes;
}

/// Nodes within `reach` voxels of x, along each axis.
void add_nodes_around(const Lattice& lattice, const Vector3& x, double reach,
                      std::vector<LatticeCoordinates>& nodes) {
  const Vector3 at = (x - lattice.origin) / lattice.voxel_size;
  LatticeCoordinates low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = static_cast<int>(std::ceil(at[axis] - reach));
    high[axis] = static_cast<int>(std::floor(at[axis] + reach));
  }
  for (int i = low[0]; i <= high[0]; ++i)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int k = low[2]; k <= high[2]; ++k) nodes.push_back({i, j, k});
}

}  // namespace

FiniteElementFit fit_finite_elements(const ElasticInput& input, const FiniteElementOptions& options,
                                     const Progress&) {
  const Stopwatch watch;
  const Points& sources = input.sources;
  const AffineMap affine =
      align_affinely(sources, input.targets, FlatDirections::of_squared_width_1e_12);
  const Matrix3 back = affine.linear.inverse();
  const Points wanted = back * (input.targets.colwise() - affine.offset) - sources;  // u of x + u(x)

  Lattice coarsest;
  coarsest.voxel_size = options.lambda / 4;
  coarsest.origin = sources.rowwise().minCoeff();
  const double size = diagonal(sources);
  const Eigen::VectorXd areas = vertex_areas(input.source);
  const double mean_area = areas.sum() / static_cast<double>(sources.cols());

  std::vector<std::vector<LatticeCoordinates>> nodes{
      band_nodes(input.source.vertices, &input.source.faces, coarsest, options.lambda)};
  auto elements = std::make_unique<NestedElements>(coarsest, nodes);
  Points coefficients = Points::Zero(3, static_cast<Eigen::Index>(elements->unknowns()));
  FiniteElementSummary summary;
  const bool verbose = std::getenv("FE_VERBOSE") != nullptr;
  for (int level = 0;; ++level) {
    std::vector<VertexTerm> terms;
    for (Eigen::Index v = 0; v < sources.cols(); ++v) {
      std::vector<ElementPlace> places = elements->places(sources.col(v));
      if (places.empty()) continue;
      terms.push_back({std::move(places), wanted.col(v), mean_area / options.compliance});
    }
    LatticeObjective objective(*elements, std::move(terms));
    const Stopwatch solve;
    if (level == 0) {
      const double start = std::getenv("FE_START") ? std::atof(std::getenv("FE_START")) : 1e-2;
      const double factor = std::getenv("FE_FACTOR") ? std::atof(std::getenv("FE_FACTOR")) : 4;
      for (double soft = start * size; soft > options.compliance * 1.5; soft /= factor) {
        objective.set_weight(mean_area / soft);
        const int its = minimise(objective, coefficients, options.iterations, 1e-2);
        if (verbose) {
          const Statistics at = summarize(objective.residuals(coefficients));
          std::fprintf(stderr, "  soft %.3g: %d iterations, %d evals, p50 %.4f%% max %.4f%% min det %.4f\n", soft / size, its, objective.evaluations, 100 * at.median / size, 100 * at.max / size, objective.min_determinant);
        }
      }
      objective.set_weight(mean_area / options.compliance);
    }
    const double decrease = std::getenv("FE_DECREASE") ? std::atof(std::getenv("FE_DECREASE")) : 1e-3;
    summary.iterations.push_back(minimise(objective, coefficients, options.iterations, decrease));
    const std::vector<double> residuals = objective.residuals(coefficients);
    summary.residuals = summarize(residuals);
    summary.min_determinant = objective.min_determinant;
    std::size_t missed = 0;
    for (const double r : residuals) missed += r > options.tolerance;
    std::size_t cells = 0;
    for (const ElementLevel& each : elements->levels()) cells += each.finest.size();
    if (verbose)
      std::fprintf(stderr, "level %d: h %.4f%% unknown nodes %zu cells %zu iterations %d evals %d  %.2f s  missed %zu  p50 %.4f%% p95 %.4f%% p99 %.4f%% max %.3f%%  min det %.4f (total %.2f s)\n",
                   level, 100 * elements->levels().back().voxel_size / size, elements->unknowns(), cells,
                   summary.iterations.back(), objective.evaluations, solve.seconds(), missed,
                   100 * summary.residuals.median / size, 100 * summary.residuals.p95 / size,
                   100 * summary.residuals.p99 / size, 100 * summary.residuals.max / size,
                   objective.min_determinant, watch.seconds());
    if (level == options.max_levels || missed == 0) break;
    nodes.clear();
    for (const ElementLevel& each : elements->levels()) nodes.push_back(each.nodes);
    nodes.emplace_back();
    const Lattice finer{coarsest.origin, elements->levels().back().voxel_size / 2};
    const double reach = std::getenv("FE_REACH") ? std::atof(std::getenv("FE_REACH")) : 2;
    for (Eigen::Index v = 0; v < sources.cols(); ++v)
      if (residuals[static_cast<std::size_t>(v)] > options.tolerance)
        add_nodes_around(finer, sources.col(v), reach, nodes.back());
    auto refined = std::make_unique<NestedElements>(coarsest, nodes);
    coefficients = transferred(*elements, coefficients, *refined);
    elements = std::move(refined);
  }
  for (const ElementLevel& each : elements->levels()) {
    summary.voxel_sizes.push_back(each.voxel_size);
    summary.nodes.push_back(each.nodes.size());
    summary.cells.push_back(each.finest.size());
  }
  Pyramid pyramid = pyramid_of(*elements, coefficients, affine.linear);
  for (PyramidLevel& each : pyramid.levels)
    round_values(each.values, options.tolerance, ValuePrecision::single);
  summary.seconds = watch.seconds();
  return {std::make_shared<BakedMap>(affine, std::move(pyramid)), summary};
}

}  // namespace bespoke
