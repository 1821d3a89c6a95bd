#include "bespoke/pipeline/elastic_steps.h"

#include <Eigen/LU>
#include <algorithm>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/rigid/affine_alignment.h"

namespace bespoke {
namespace {

/// The source with loose vertices after its own.
Points with_loose(const Points& vertices, const Points& pairs, std::size_t loose) {
  const auto count = static_cast<Eigen::Index>(loose);
  Points all(3, vertices.cols() + count);
  all << vertices, pairs.rightCols(count);
  return all;
}

/// Similarities in between would hide a mirror image, which no path without folds reaches.
void require_unmirrored(const ElasticPairs& pairs) {
  const AffineMap whole =
      align_affinely(pairs.sources, pairs.targets, FlatDirections::of_squared_width_1e_12);
  const double determinant = whole.linear.determinant();
  if (determinant < 0)
    throw InvalidInput("the affine part of the correspondences has determinant " +
                       std::to_string(determinant) +
                       ", so one model is a mirror image of the other; mirror it back first");
}

}  // namespace

StepPlan plan_steps(const TriangleMesh& source, const Points& fitted, const ElasticPairs& pairs, int steps) {
  require_unmirrored(pairs);
  StepPlan plan;
  const std::size_t loose = pairs.anchors_off_surface;
  plan.path = std::make_shared<const SurfacePath>(
      TriangleMesh{with_loose(source.vertices, pairs.sources, loose), source.faces},
      with_loose(fitted, pairs.targets, loose));
  plan.times = equal_times(steps);
  return plan;
}

std::vector<double> equal_times(int steps) {
  std::vector<double> times;
  for (int k = 0; k <= steps; ++k) times.push_back(static_cast<double>(k) / steps);
  return times;
}

StepPlan halved(const StepPlan& plan, const std::vector<std::size_t>& steps) {
  StepPlan finer = plan;
  for (const std::size_t step : steps) finer.times.push_back((plan.times[step] + plan.times[step + 1]) / 2);
  std::sort(finer.times.begin(), finer.times.end());
  return finer;
}

ElasticSteps fit_elastic_steps(const TriangleMesh& source, const ElasticPairs& pairs, const StepPlan& plan,
                               ElasticMethod method, const ElasticOptions& options, ElasticSteps done,
                               const Progress& progress) {
  ElasticSteps steps = std::move(done);
  ElasticOptions step_options = options;
  step_options.affine_part = AffinePart::similarity;
  Points vertices = source.vertices;
  Points places = pairs.sources;
  const auto move_on = [&](const ElasticMap& map) {
    vertices = map(vertices);
    places = map(places);
  };
  for (const auto& map : steps.maps) move_on(*map);
  const auto loose = static_cast<Eigen::Index>(pairs.anchors_off_surface);
  for (std::size_t k = steps.maps.size(); k < plan.steps(); ++k) {
    progress.step("elastic", k, plan.steps());
    const Points next = plan.path->at(plan.times[k + 1]);
    const Points fitted = next.leftCols(source.vertices.cols());
    Points targets = places;
    targets.leftCols(places.cols() - loose) = elastic_pairs(source, fitted).targets;
    targets.rightCols(loose) = next.rightCols(loose);
    const TriangleMesh here{vertices, source.faces};
    ElasticFit fit = elastic_method(method).fit({here, fitted, places, targets}, step_options, progress);
    steps.sources.push_back(vertices);
    steps.found.push_back(std::move(fit.found));
    move_on(*fit.map);
    steps.maps.push_back(std::move(fit.map));
  }
  return steps;
}

}  // namespace bespoke
