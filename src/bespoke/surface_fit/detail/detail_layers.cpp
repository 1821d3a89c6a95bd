#include "bespoke/surface_fit/detail/detail_layers.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "bespoke/parallel.h"
#include "bespoke/rbf/kernels.h"
#include "bespoke/rbf/point_grid.h"

namespace bespoke {
namespace {

constexpr double coarsest = 0.06, ratio = 0.6;  // λ of the first scale in diagonals, and from scale to scale
constexpr int scales = 6, steps_per_scale = 2;
constexpr double centers_per_radius = 3;
constexpr double min_cosine = 0.3;
constexpr double slide = 0.1;     // weight of point-to-point beside point-to-plane
constexpr double stay = 0.03;     // weight of staying in place, against noise in single points
constexpr double max_move = 0.3;  // of λ: a layer moves nothing farther
constexpr double max_gradient = 0.5;
constexpr double ridge = 1e-3;  // bounds the condition of a layer
constexpr std::size_t grain = 128;

/// u(x) = Σ cⱼ φ(|x − zⱼ|/λ).
class Layer {
 public:
  /// Interpolates `values` (3×m) at `centers` by conjugate gradients, up to the ridge.
  Layer(double lambda, const Points& centers, const Points& values)
      : lambda_(lambda), centers_(centers), grid_(centers, lambda), coefficients_(solve(values)) {}

  void scale(double factor) { coefficients_ *= factor; }

  Vector3 displacement(const Vector3& x) const {
    Vector3 sum = Vector3::Zero();
    grid_.for_each_within(x, lambda_, [&](int j, double squared) {
      sum += WendlandC4::value(std::sqrt(squared) / lambda_) * coefficients_.col(j);
    });
    return sum;
  }

  double gradient_norm(const Vector3& x) const {
    Matrix3 gradient = Matrix3::Zero();
    grid_.for_each_within(x, lambda_, [&](int j, double squared) {
      const double slope = WendlandC4::slope_over_s(std::sqrt(squared) / lambda_) / (lambda_ * lambda_);
      gradient += coefficients_.col(j) * (slope * (x - centers_.col(j))).transpose();
    });
    return gradient.norm();
  }

 private:
  Points solve(const Points& values) const {
    constexpr int max_iterations = 40;
    constexpr double enough = 1e-6;  // of the squared residual
    const Eigen::Index count = centers_.cols();
    std::vector<std::vector<std::pair<int, double>>> rows(static_cast<std::size_t>(count));
    parallel_for(rows.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        grid_.for_each_within(centers_.col(static_cast<Eigen::Index>(i)), lambda_,
                              [&](int j, double squared) {
                                const double value = WendlandC4::value(std::sqrt(squared) / lambda_);
                                if (value > 1e-6) rows[i].emplace_back(j, value);
                              });
    });
    Points solution = Points::Zero(3, count), residual = values, direction = values, image(3, count);
    Vector3 squared = residual.rowwise().squaredNorm();
    const Vector3 first = squared;
    for (int iteration = 0; iteration < max_iterations && !(squared.array() <= enough * first.array()).all();
         ++iteration) {
      parallel_for(rows.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const auto column = static_cast<Eigen::Index>(i);
          Vector3 sum = ridge * direction.col(column);
          for (const auto& [j, value] : rows[i]) sum += value * direction.col(j);
          image.col(column) = sum;
        }
      });
      const Vector3 curvature = direction.cwiseProduct(image).rowwise().sum();
      const Vector3 length =
          (curvature.array() > 0).select(squared.cwiseQuotient(curvature), Vector3::Zero());
      solution += length.asDiagonal() * direction;
      residual -= length.asDiagonal() * image;
      const Vector3 next = residual.rowwise().squaredNorm();
      const Vector3 turn = (squared.array() > 0).select(next.cwiseQuotient(squared), Vector3::Zero());
      direction = residual + turn.asDiagonal() * direction;
      squared = next;
    }
    return solution;
  }

  double lambda_;
  Points centers_;
  PointGrid grid_;
  Points coefficients_;
};

struct Residual {
  Matrix3 form = Matrix3::Zero();  // zero: no counterpart
  Vector3 pull = Vector3::Zero();  // form · (counterpart − vertex)
};

std::vector<Residual> residuals(const DetailInput& input, const TriangleMesh& moved,
                                const Eigen::VectorXd& areas, double within) {
  std::vector<Residual> all(static_cast<std::size_t>(moved.vertices.cols()));
  const Points normals = vertex_normals(moved);
  parallel_for(all.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const auto found = input.target.match(moved.vertices.col(i), normals.col(i), {min_cosine, within});
      if (!found) continue;
      const double weight = areas[i] * found->agreement * found->agreement;
      all[k].form = weight * (found->halfway * found->halfway.transpose() + slide * Matrix3::Identity());
      all[k].pull = all[k].form * (found->point - moved.vertices.col(i));
    }
  });
  return all;
}

struct Samples {
  Points centers, values;
};

/// Anchors first, so that thinning keeps them; then averages of the residuals around the thinned vertices.
Samples sample(const DetailInput& input, const Points& anchors, const Points& vertices,
               const std::vector<Residual>& residuals, const Eigen::VectorXd& areas, double lambda) {
  const double spacing = lambda / centers_per_radius;
  Points candidates(3, anchors.cols() + vertices.cols());
  candidates << anchors, vertices;
  const std::vector<int> kept = thin_points(candidates, spacing);
  const PointGrid grid(vertices, spacing);
  Samples samples{Points(3, static_cast<Eigen::Index>(kept.size())),
                  Points(3, static_cast<Eigen::Index>(kept.size()))};
  parallel_for(kept.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      samples.centers.col(column) = candidates.col(kept[k]);
      Vector3 value;
      if (kept[k] < anchors.cols()) {
        value = input.anchor_targets.col(kept[k]) - anchors.col(kept[k]);
      } else {
        Matrix3 form = Matrix3::Zero();
        Vector3 pull = Vector3::Zero();
        double total = 0;
        grid.for_each_within(candidates.col(kept[k]), spacing, [&](int i, double squared) {
          const double weight = WendlandC4::value(std::sqrt(squared) / spacing);
          total += weight * areas[i];
          form += weight * residuals[i].form;
          pull += weight * residuals[i].pull;
        });
        form.diagonal().array() += stay * total;
        value = total > 0 ? Vector3(form.ldlt().solve(pull)) : Vector3(Vector3::Zero());
      }
      samples.values.col(column) = value * std::min(1.0, max_move * lambda / std::max(value.norm(), 1e-300));
    }
  });
  return samples;
}

/// Moves vertices and anchors; root mean square of the vertices' displacements.
double apply(Layer& layer, Points& vertices, Points& anchors) {
  const std::size_t count = static_cast<std::size_t>(vertices.cols());
  const double steepest = parallel_reduce(
      count, grain, 0.0,
      [&](std::size_t begin, std::size_t end) {
        double largest = 0;
        for (std::size_t i = begin; i < end; ++i)
          largest = std::max(largest, layer.gradient_norm(vertices.col(static_cast<Eigen::Index>(i))));
        return largest;
      },
      [](double a, double b) { return std::max(a, b); });
  if (steepest > max_gradient) layer.scale(max_gradient / steepest);
  Points step(3, vertices.cols());
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i)
      step.col(i) = layer.displacement(vertices.col(i));
  });
  for (auto&& anchor : anchors.colwise()) anchor += layer.displacement(anchor);
  vertices += step;
  return std::sqrt(step.squaredNorm() / double(count));
}

}  // namespace

DetailFit fit_details(const DetailInput& input, const Progress& progress) {
  const Eigen::VectorXd areas = vertex_areas(input.surface);
  TriangleMesh moved = input.surface;
  DetailFit fit;
  fit.anchor_sources = input.anchor_sources;
  double lambda = coarsest * input.diagonal;
  for (int scale = 0; scale < scales; ++scale, lambda *= ratio)
    for (int step = 0; step < steps_per_scale; ++step) {
      progress.step("surface-fit details", static_cast<std::size_t>(fit.layers), scales * steps_per_scale);
      const double within = std::max(lambda, 0.01 * input.diagonal);
      const Samples samples = sample(input, fit.anchor_sources, moved.vertices,
                                     residuals(input, moved, areas, within), areas, lambda);
      Layer layer(lambda, samples.centers, samples.values);
      fit.last_step = apply(layer, moved.vertices, fit.anchor_sources);
      ++fit.layers;
    }
  fit.vertices = std::move(moved.vertices);
  return fit;
}

DetailFit meet_anchors(const DetailInput& input) {
  DetailFit fit{input.surface.vertices, input.anchor_sources, 0, 0};
  if (fit.anchor_sources.cols() == 0) return fit;
  Layer layer(coarsest / 2 * input.diagonal, fit.anchor_sources, input.anchor_targets - fit.anchor_sources);
  fit.last_step = apply(layer, fit.vertices, fit.anchor_sources);
  fit.layers = 1;
  return fit;
}

}  // namespace bespoke
