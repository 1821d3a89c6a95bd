#include "bespoke/surface_fit/graph/similarity_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/rbf/point_grid.h"

namespace bespoke {
namespace {

struct PlaneResidual {
  Vector3 point, normal;
  double distance = 0, weight = 0;  // weight 0: no counterpart
};

std::vector<PlaneResidual> plane_residuals(const TriangleMesh& moved, const Eigen::VectorXd& areas,
                                           const TargetSurface& target, const MatchLimits& limits,
                                           std::size_t max_samples) {
  const Points& vertices = moved.vertices;
  const Points normals = vertex_normals(moved);
  const std::size_t count = static_cast<std::size_t>(vertices.cols());
  const std::size_t stride = (count + max_samples - 1) / max_samples;
  std::vector<PlaneResidual> residuals((count + stride - 1) / stride);
  constexpr std::size_t grain = 256;
  parallel_for(residuals.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<Eigen::Index>(k * stride);
      const auto found = target.match(vertices.col(i), normals.col(i), limits);
      if (!found) continue;
      residuals[k] = {vertices.col(i), found->normal, found->normal.dot(found->point - vertices.col(i)),
                      areas[i]};
    }
  });
  std::erase_if(residuals, [](const PlaneResidual& r) { return !(r.weight > 0); });
  return residuals;
}

constexpr double middle = 0.5;

double quantile(const std::vector<PlaneResidual>& residuals, double fraction) {
  std::vector<double> distances;
  for (const PlaneResidual& r : residuals) distances.push_back(std::abs(r.distance));
  const auto nth = distances.begin() + static_cast<std::ptrdiff_t>(fraction * double(distances.size() - 1));
  std::nth_element(distances.begin(), nth, distances.end());
  return *nth;
}

/// Of each residual with the mean of some ten around it that face the same way; those far beyond the others
/// count as less. area: of the surface.
double neighbour_correlation(const std::vector<PlaneResidual>& residuals, double area, double min_cosine) {
  constexpr double neighbours = 10, most = 4;  // the latter in medians
  const double radius =
      std::sqrt(neighbours * area / (std::numbers::pi * static_cast<double>(residuals.size())));
  const double limit = most * quantile(residuals, middle);
  Points points(3, residuals.size());
  std::vector<double> clipped(residuals.size()), means(residuals.size(), 0.0);
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    points.col(static_cast<Eigen::Index>(k)) = residuals[k].point;
    clipped[k] = std::clamp(residuals[k].distance, -limit, limit);
  }
  const PointGrid grid(points, radius);
  parallel_for(residuals.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      double sum = 0, count = 0;
      grid.for_each_within(residuals[k].point, radius, [&](int other, double) {
        const auto at = static_cast<std::size_t>(other);
        if (at == k || !(residuals[at].normal.dot(residuals[k].normal) > min_cosine)) return;
        sum += clipped[at];
        ++count;
      });
      if (count > 0) means[k] = sum / count;
    }
  });
  double product = 0, square = 0;
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    product += clipped[k] * means[k];
    square += clipped[k] * clipped[k];
  }
  return square > 0 ? product / square : 0;
}

/// One Gauss-Newton step on rotation, translation and scale about the centroid, iteratively reweighted
/// (Holland, Welsch 1977).
Similarity step(const std::vector<PlaneResidual>& residuals, double robust_scale) {
  Vector3 center = Vector3::Zero();
  for (const PlaneResidual& r : residuals) center += r.point / double(residuals.size());
  Eigen::Matrix<double, 7, 7> normal_matrix = Eigen::Matrix<double, 7, 7>::Zero();
  Eigen::Matrix<double, 7, 1> right_side = Eigen::Matrix<double, 7, 1>::Zero();
  for (const PlaneResidual& r : residuals) {
    const Vector3 arm = r.point - center;
    // Cauchy's weights: where the models differ, the residual is no misfit of the similarity.
    const double outlier = r.distance / robust_scale;
    const double weight = r.weight / (1 + outlier * outlier);
    // Derivatives of n · x by a small rotation vector, a translation and the logarithm of the scale: point to
    // plane (Chen, Medioni 1992).
    Eigen::Matrix<double, 7, 1> row;
    row << arm.cross(r.normal), r.normal, arm.dot(r.normal);
    normal_matrix += weight * row * row.transpose();
    right_side += weight * r.distance * row;
  }
  // A sphere or a plane leaves rotations or shifts undetermined: they stay as they are.
  const Eigen::Matrix<double, 7, 1> change =
      normal_matrix.completeOrthogonalDecomposition().solve(right_side);
  Similarity result;
  result.scale = std::exp(change[6]);
  const double angle = change.head<3>().norm();
  if (angle > 0) result.rotation = Eigen::AngleAxisd(angle, change.head<3>() / angle).toRotationMatrix();
  result.translation = center + change.segment<3>(3) - result.scale * (result.rotation * center);
  return result;
}

}  // namespace

SimilarityFit fit_similarity(const TriangleMesh& source, const TargetSurface& target, const Similarity& start,
                             const SimilaritySettings& settings) {
  const Eigen::VectorXd areas = vertex_areas(source);
  const double tolerance = settings.tolerance;
  const double within = settings.max_distance;
  const MatchLimits limits{settings.min_cosine, within};
  std::vector<PlaneResidual> residuals;
  SimilarityFit fit;
  fit.target_from_source = start;
  TriangleMesh moved = source;
  for (int iteration = 0;; ++iteration) {
    moved.vertices = fit.target_from_source * source.vertices;
    residuals = plane_residuals(moved, areas, target, limits, settings.max_samples);
    if (residuals.empty()) return {start, within, false};
    fit.residual = quantile(residuals, settings.quantile);
    // Most pairs are no similar copies; they must not pay for all iterations.
    const bool give_up =
        iteration >= settings.trial_iterations && !(fit.residual <= settings.early_exit_factor * tolerance);
    if (iteration == settings.max_iterations || give_up) break;
    const double robust_scale =
        settings.outlier_medians * quantile(residuals, middle) + settings.outlier_floor * within;
    fit.target_from_source = step(residuals, robust_scale) * fit.target_from_source;
  }
  constexpr double deviation_of_median = 1.4826;  // of a normal distribution
  fit.standard_error =
      deviation_of_median * quantile(residuals, middle) / std::sqrt(static_cast<double>(residuals.size()));
  fit.suffices = fit.residual <= tolerance;
  if (!fit.suffices && fit.residual <= settings.max_noise * tolerance) {
    const auto of_all = plane_residuals(moved, areas, target, limits, static_cast<std::size_t>(areas.size()));
    fit.suffices =
        neighbour_correlation(of_all, areas.sum(), settings.min_cosine) <= settings.noise_correlation;
  }
  return fit;
}

}  // namespace bespoke
