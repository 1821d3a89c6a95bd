#include "bespoke/pipeline/elastic_steps.h"

#include <algorithm>
#include <utility>

namespace bespoke {
namespace {

/// The source with loose vertices after its own.
Points with_loose(const Points& vertices, const Points& pairs, std::size_t loose) {
  const auto count = static_cast<Eigen::Index>(loose);
  Points all(3, vertices.cols() + count);
  all << vertices, pairs.rightCols(count);
  return all;
}

}  // namespace

StepPlan plan_steps(const TriangleMesh& source, const Points& fitted, const ElasticPairs& pairs, int steps) {
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
