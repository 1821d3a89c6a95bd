#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bespoke/elastic/detail/upright_affine.h"
#include "bespoke/elastic/multiscale.h"
#include "bespoke/error.h"
#include "bespoke/mapping/affine_map.h"
#include "bespoke/rbf/gradient_bound.h"
#include "bespoke/rbf/layer_solver.h"
#include "bespoke/rbf/layer_stack.h"
#include "bespoke/rbf/point_grid.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

// Of a composed layer: residuals are clipped to this fraction of λ_k, …
constexpr double largest_step = 0.3;
// … its gradient is held below this bound, …
constexpr double largest_gradient = 0.9;
// … and a scale takes so many layers at most while clipping or damping keeps one from finishing.
constexpr int max_layers_per_scale = 6;
// λ_k in tolerances below which a layer could repair next to nothing.
constexpr double min_radius = 4;
// Of a guide's offset: how far it may be missed. Not varied.
constexpr double guide_tolerance = 0.05;

void require_usable(const SpaceGuides& guides) {
  const Eigen::Index count = guides.sources.cols();
  if (guides.targets.cols() != count || !guides.sources.allFinite() || !guides.targets.allFinite() ||
      (count > 0 && !(guides.offset > 0)))
    throw InvalidInput(
        "multiscale: guides need finite sources, as many finite targets, and an offset above 0");
}

void require_usable(const Points& sources, const Points& targets, const MultiscaleOptions& options) {
  if (sources.cols() != targets.cols())
    throw InvalidInput("multiscale: " + std::to_string(sources.cols()) + " sources and " +
                       std::to_string(targets.cols()) + " targets; the numbers must be equal");
  if (sources.cols() == 0) throw InvalidInput("multiscale: there are no sources");
  if (!sources.allFinite() || !targets.allFinite())
    throw InvalidInput("multiscale: a source or target has a coordinate that is not finite");
  if (!(options.lambda > 0) || !std::isfinite(options.lambda))
    throw InvalidInput("multiscale: effective distance " + std::to_string(options.lambda) +
                       " must be positive and finite");
  if (!(options.tolerance > 0))
    throw InvalidInput("multiscale: tolerance " + std::to_string(options.tolerance) + " must be positive");
  if (!(options.max_levels > 0))
    throw InvalidInput("multiscale: " + std::to_string(options.max_levels) +
                       " levels; there must be one at least");
  require_usable(options.guides);
}

/// Damps the layer's coefficients around places where its gradient may exceed the bound, then scales what is
/// left. Returns the bound that holds now, and whether the layer met it untouched.
struct LimitedLayer {
  double bound = 0;
  bool untouched = true;
};

LimitedLayer limit_gradient(RbfLayer& layer) {
  constexpr int dampings = 4;
  // Damping varies from place to place, which adds to the gradient.
  constexpr double aim = 0.85;
  const PointGrid grid(layer.centers, 2 * layer.lambda);
  GradientBound bound;
  std::vector<char> changed;
  for (int pass = 0; pass < dampings; ++pass) {
    bound.update(layer, largest_gradient, GradientBound::Closeness::rough, changed);
    if (bound.largest() <= largest_gradient) return {bound.largest(), pass == 0};
    Eigen::RowVectorXd factors = Eigen::RowVectorXd::Ones(layer.centers.cols());
    for (const auto& [center, radius, estimate] : bound.steep_places()) {
      const double factor = aim * largest_gradient / std::max(estimate, largest_gradient);
      const double reach = layer.lambda + radius;
      grid.for_each_within(center, reach + layer.lambda, [&](int j, double squared) {
        const double ramp = std::clamp((std::sqrt(squared) - reach) / layer.lambda, 0.0, 1.0);
        factors[j] = std::min(factors[j], factor + (1 - factor) * ramp);
      });
    }
    layer.coefficients.array().rowwise() *= factors.array();
    changed.resize(std::size_t(factors.size()));
    for (std::size_t j = 0; j < changed.size(); ++j) changed[j] = factors[Eigen::Index(j)] < 1;
  }
  bound.update(layer, largest_gradient, GradientBound::Closeness::tight, changed);
  if (bound.largest() <= largest_gradient) return {bound.largest(), false};
  layer.coefficients *= largest_gradient / bound.largest();
  return {largest_gradient, false};
}

class Fitter {
 public:
  Fitter(const Points& sources, const Points& targets, const MultiscaleOptions& options,
         const Progress& progress)
      : pairs_(sources.cols()),
        sources_(joined(sources, options.guides.sources)),
        targets_(joined(targets, options.guides.targets)),
        options_(options),
        progress_(progress),
        affine_(upright_affine(sources, targets, options.affine_part)),
        growth_(options.composed ? 1 : power_of_two_scale(affine_)),
        images_(affine_ * sources_) {}

  MultiscaleFit run() {
    double lambda = options_.lambda;
    for (int level = 0; level < options_.max_levels && worst() > options_.tolerance &&
                        lambda > min_radius * options_.tolerance / growth_;
         ++level, lambda /= 2) {
      progress_.step("elastic", std::size_t(level), std::size_t(options_.max_levels));
      if (options_.composed)
        compose_scale(lambda);
      else
        add(solve_layer(centers_at(lambda), residuals_at_centers_, lambda, options_.tolerance / 10));
    }
    finish();
    return {std::make_shared<MultiscaleMap>(affine_, std::move(layers_), options_.composed),
            std::move(summary_)};
  }

 private:
  static Points joined(const Points& points, const Points& guides) {
    Points all(3, points.cols() + guides.cols());
    all << points, guides;
    return all;
  }

  double worst() const { return (targets_ - images_).leftCols(pairs_).colwise().norm().maxCoeff(); }

  /// How many points a layer of this radius goes by: finer ones are the surface's alone.
  Eigen::Index points_for(double lambda) const {
    return lambda >= options_.guides.offset ? sources_.cols() : pairs_;
  }

  double tolerance(Eigen::Index i) const {
    return i < pairs_ ? options_.tolerance
                      : std::max(options_.tolerance, guide_tolerance * growth_ * options_.guides.offset);
  }

  /// Residual correction (Floater, Iske 1996) in composed form: displacements clipped and gradients below 1
  /// keep every layer a diffeomorphism.
  void compose_scale(double lambda) {
    for (int count = 0; count < max_layers_per_scale; ++count) {
      progress_.check();
      const double before = (targets_ - images_).leftCols(pairs_).squaredNorm();
      const Points centers = centers_at(lambda);
      bool finished = true;
      for (auto value : residuals_at_centers_.colwise()) {
        const double length = value.norm();
        if (length <= largest_step * lambda) continue;
        value *= largest_step * lambda / length;
        finished = false;
      }
      RbfLayer layer = solve_layer(centers, residuals_at_centers_, lambda, options_.tolerance / 10);
      const LimitedLayer limited = limit_gradient(layer);
      if (!limited.untouched) finished = false;
      summary_.gradient_bounds.push_back(limited.bound);
      add(std::move(layer));
      constexpr double min_progress = 0.9;
      if (finished || worst() <= options_.tolerance) return;
      if ((targets_ - images_).leftCols(pairs_).squaredNorm() > min_progress * before) return;
    }
  }

  /// Thinned places where a residual exceeds the tolerance, with those around them, which must not be dragged
  /// along; fills residuals_at_centers_.
  Points centers_at(double lambda) {
    const Eigen::Index count = points_for(lambda);
    const Points places = (options_.composed ? images_ : sources_).leftCols(count);
    const double spacing = lambda / 4;
    const Points residuals = (targets_ - images_).leftCols(count);
    std::vector<int> beyond;
    for (int i = 0; i < residuals.cols(); ++i)
      if (residuals.col(i).norm() > tolerance(i)) beyond.push_back(i);
    const Points wanted = places(Eigen::all, beyond);
    const Points wanted_thinned = wanted(Eigen::all, thin_points(wanted, spacing));
    const PointGrid wanted_grid(wanted_thinned, lambda);

    std::vector<int> kept;
    for (const int i : thin_points(places, spacing)) {
      bool near = false;
      wanted_grid.for_each_within(places.col(i), lambda, [&](int, double) { near = true; });
      if (near) kept.push_back(i);
    }
    residuals_at_centers_ = residuals(Eigen::all, kept);
    return places(Eigen::all, kept);
  }

  void add(RbfLayer layer) {
    const LayerStack stack({LayerEvaluator(layer.centers, layer.coefficients, layer.lambda, Wendland::c2)},
                           Stacking::summed);
    images_ += stack.displacement(options_.composed ? images_ : sources_);
    summary_.lambdas.push_back(layer.lambda);
    summary_.centers.push_back(std::size_t(layer.centers.cols()));
    layers_.push_back(std::move(layer));
  }

  void finish() {
    const Eigen::RowVectorXd residuals = (targets_ - images_).leftCols(pairs_).colwise().norm();
    summary_.residuals = summarize({residuals.begin(), residuals.end()});
    summary_.within_tolerance = std::size_t((residuals.array() <= options_.tolerance).count());
  }

  Eigen::Index pairs_;  // at the front of the points; guides follow
  Points sources_;
  Points targets_;
  const MultiscaleOptions& options_;
  const Progress& progress_;
  AffineMap affine_;
  double growth_;  // of sizes, from where layers act to the targets
  Points images_;  // E(sources) so far
  Points residuals_at_centers_;
  std::vector<RbfLayer> layers_;
  MultiscaleSummary summary_;
};

}  // namespace

MultiscaleFit fit_multiscale(const Points& sources, const Points& targets, const MultiscaleOptions& options,
                             const Progress& progress) {
  const Stopwatch watch;
  require_usable(sources, targets, options);
  MultiscaleFit fit = Fitter(sources, targets, options, progress).run();
  fit.summary.seconds = watch.seconds();
  return fit;
}

}  // namespace bespoke
