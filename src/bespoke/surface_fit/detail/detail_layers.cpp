#include "bespoke/surface_fit/detail/detail_layers.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "bespoke/parallel.h"
#include "bespoke/rbf/kernels.h"
#include "bespoke/rbf/layer_solver.h"
#include "bespoke/rbf/point_grid.h"
#include "bespoke/surface_fit/matching/reciprocity.h"

namespace bespoke {
namespace {

constexpr std::size_t layer_grain = 128;

/// u(x) = Σ cⱼ φ(|x − zⱼ|/λ).
class Layer {
 public:
  /// Interpolates `values` (3×m) at `centers`, up to the ridge.
  Layer(double lambda, const Points& centers, const Points& values, const DetailSettings& settings)
      : lambda_(lambda),
        centers_(centers),
        grid_(centers, lambda),
        coefficients_(smooth_layer(centers, values, lambda, settings.solver)) {}

  void scale(double factor) { coefficients_ *= factor; }

  struct Jet {
    Vector3 displacement;
    double gradient_norm;  // ‖∇u(x)‖
  };

  Jet operator()(const Vector3& x) const {
    Vector3 sum = Vector3::Zero();
    Matrix3 gradient = Matrix3::Zero();
    grid_.for_each_within(x, lambda_, [&](int j, double squared) {
      const double s = std::sqrt(squared) / lambda_;
      const double slope = WendlandC4::slope_over_s(s) / (lambda_ * lambda_);
      sum += WendlandC4::value(s) * coefficients_.col(j);
      gradient += coefficients_.col(j) * (slope * (x - centers_.col(j))).transpose();
    });
    return {sum, gradient.norm()};
  }

 private:
  double lambda_;
  Points centers_;
  PointGrid grid_;
  Points coefficients_;
};

struct Residual {
  Matrix3 form = Matrix3::Zero();  // zero: no counterpart
  Vector3 pull = Vector3::Zero();  // form · (counterpart − vertex)
};

/// One scale: what moves, towards what, with a layer of radius `lambda`.
struct DetailStep {
  const DetailInput& input;
  const DetailSettings& settings;
  const TargetSurface& moved;
  const Points& anchors;         // 3×k, where they are now
  const Eigen::VectorXd& areas;  // of the vertices
  double lambda;                 // diagonals
};

std::vector<Residual> residuals(const DetailStep& step) {
  const Points& vertices = step.moved.mesh().vertices;
  const Points& normals = step.moved.normals();
  std::vector<Residual> all(static_cast<std::size_t>(vertices.cols()));
  const MatchLimits limits{step.settings.min_cosine, std::max(step.lambda, step.settings.min_reach)};
  parallel_for(all.size(), layer_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      MatchLimits own = limits;
      own.patch = step.moved.patch(i);
      const auto found = step.input.target.match(vertices.col(i), normals.col(i), own);
      if (!found) continue;
      const ReciprocitySettings& settings = step.settings.reciprocity;
      const double back =
          back_distance_ratio({vertices.col(i), *found, own}, step.moved, settings.much_nearer, settings);
      const double weight = step.areas[i] * found->agreement * found->agreement * reciprocity(back, settings);
      all[k].form =
          weight * (found->halfway * found->halfway.transpose() + step.settings.slide * Matrix3::Identity());
      all[k].pull = all[k].form * (found->point - vertices.col(i));
    }
  });
  return all;
}

/// The displacement that the residuals around a centre agree on: the minimum of their quadratic forms,
/// weighted by distance, and of the term that keeps the centre in place.
Vector3 agreed_displacement(const DetailStep& step, const std::vector<Residual>& residuals,
                            const PointGrid& grid, const Vector3& center, double spacing) {
  Matrix3 form = Matrix3::Zero();
  Vector3 pull = Vector3::Zero();
  double total = 0;
  grid.for_each_within(center, spacing, [&](int i, double squared) {
    const double weight = WendlandC4::value(std::sqrt(squared) / spacing);
    total += weight * step.areas[i];
    form += weight * residuals[i].form;
    pull += weight * residuals[i].pull;
  });
  form.diagonal().array() += step.settings.stay * total;
  return total > 0 ? Vector3(form.ldlt().solve(pull)) : Vector3(Vector3::Zero());
}

struct Samples {
  Points centers, values;
};

/// Anchors first, so that thinning keeps them; then averages of the residuals around the thinned vertices.
Samples sample(const DetailStep& step) {
  constexpr double tiny = 1e-300;  // no move, no division by zero
  const std::vector<Residual> found = residuals(step);
  const double spacing = step.lambda / step.settings.centers_per_radius;
  const Points& vertices = step.moved.mesh().vertices;
  Points candidates(3, step.anchors.cols() + vertices.cols());
  candidates << step.anchors, vertices;
  const std::vector<int> kept = thin_points(candidates, spacing);
  const PointGrid grid(vertices, spacing);
  Samples samples{candidates(Eigen::all, kept), Points(3, static_cast<Eigen::Index>(kept.size()))};
  parallel_for(kept.size(), layer_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const Vector3 value = kept[k] < step.anchors.cols()
                                ? Vector3(step.input.anchor_targets.col(kept[k]) - step.anchors.col(kept[k]))
                                : agreed_displacement(step, found, grid, candidates.col(kept[k]), spacing);
      const double most = step.settings.max_move * step.lambda;
      samples.values.col(column) = value * std::min(1.0, most / std::max(value.norm(), tiny));
    }
  });
  return samples;
}

/// Moves vertices and anchors; root mean square of the vertices' displacements.
double apply(Layer& layer, double max_gradient, Points& vertices, Points& anchors) {
  const std::size_t count = static_cast<std::size_t>(vertices.cols());
  Points step(3, vertices.cols());
  Eigen::VectorXd gradient_norms(vertices.cols());
  const auto look = [&] {
    parallel_for(count, layer_grain, [&](std::size_t begin, std::size_t end) {
      for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) {
        const Layer::Jet jet = layer(vertices.col(i));
        step.col(i) = jet.displacement;
        gradient_norms[i] = jet.gradient_norm;
      }
    });
  };
  look();
  if (const double steepest = gradient_norms.maxCoeff(); steepest > max_gradient) {
    layer.scale(max_gradient / steepest);
    look();
  }
  for (auto&& anchor : anchors.colwise()) anchor += layer(anchor).displacement;
  vertices += step;
  return std::sqrt(step.squaredNorm() / double(count));
}

}  // namespace

DetailFit fit_details(const DetailInput& input, const DetailSettings& settings, const Progress& progress) {
  const TargetSurface surface(input.surface, input.patches);
  Eigen::VectorXd areas = surface.areas();
  for (Eigen::Index i = 0; i < areas.size(); ++i) {
    const bool is_hidden = !input.hidden.empty() && input.hidden[static_cast<std::size_t>(i)];
    if (is_hidden || surface.is_excluded(i)) areas[i] = 0;
  }
  const int layers = settings.scales * settings.steps_per_scale;
  DetailFit fit;
  fit.vertices = input.surface.vertices;
  fit.anchor_sources = input.anchor_sources;
  double lambda = settings.coarsest;
  for (int scale = 0; scale < settings.scales; ++scale, lambda *= settings.ratio)
    for (int step = 0; step < settings.steps_per_scale; ++step, ++fit.layers) {
      progress.step("surface-fit details", static_cast<std::size_t>(fit.layers),
                    static_cast<std::size_t>(layers));
      const TargetSurface moved = surface.moved(fit.vertices);
      const Samples samples = sample({input, settings, moved, fit.anchor_sources, areas, lambda});
      Layer layer(lambda, samples.centers, samples.values, settings);
      fit.last_step = apply(layer, settings.max_gradient, fit.vertices, fit.anchor_sources);
    }
  return fit;
}

DetailFit meet_anchors(const DetailInput& input, const DetailSettings& settings) {
  DetailFit fit{input.surface.vertices, input.anchor_sources, 0, 0};
  if (fit.anchor_sources.cols() == 0) return fit;
  Points moves = input.anchor_targets - fit.anchor_sources;
  do {
    Layer layer(settings.anchor_radius, fit.anchor_sources, moves, settings);
    fit.last_step = apply(layer, settings.max_gradient, fit.vertices, fit.anchor_sources);
    ++fit.layers;
    moves = input.anchor_targets - fit.anchor_sources;
  } while (fit.layers < settings.max_anchor_passes && moves.colwise().norm().maxCoeff() > settings.tolerance);
  return fit;
}

}  // namespace bespoke
