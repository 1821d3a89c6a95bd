#include "bespoke/pipeline/detail/fit_steps.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "bespoke/length.h"
#include "bespoke/pipeline/detail/unusable_fit.h"

namespace bespoke {

MapProblem map_problem(const TriangleMesh& source, const Registration& registration,
                       const FitOptions& options) {
  // A vertex and an anchor closer than this ask an interpolating map for differences of rounding errors.
  constexpr double min_distance = 1e-6;  // of the source's diagonal
  const double tolerance =
      options.fit_tolerance / power_of_two_scale(growth(source, registration.fitted_vertices));
  const std::vector<std::size_t> off = anchors_off_surface(
      source, registration.anchors, std::max(tolerance, min_distance * diagonal(source.vertices)));
  ElasticPairs pairs = elastic_pairs(source, registration.fitted_vertices);
  if (!off.empty() && elastic_method(options.elastic).meets_points)
    pairs =
        with_anchors(std::move(pairs), registration.anchors, off, inverse(registration.target_from_source));
  return {source, registration, std::move(pairs), off.size()};
}

std::vector<double> anchor_residuals(const MapFit& fit, const Registration& registration,
                                     const Anchors& anchors) {
  return distances(registration.target_from_source * (*fit.elastic)(source_points(anchors)),
                   target_points(anchors));
}

double met_within(const FitOptions& options) {
  return elastic_method(options.elastic).met_within * options.fit_tolerance;
}

bool follows_fit(const MapFit& fit, const FitOptions& options) {
  return fit.summary.vertex_residuals.p95 <= met_within(options);
}

FitOptions without_guides(FitOptions options) {
  options.guides = GuidedMaps::none;
  return options;
}

ElasticOptions elastic_options(const FitOptions& options, bool of_steps) {
  const bool guided = options.guides == GuidedMaps::all || (of_steps && options.guides == GuidedMaps::steps);
  return {options.lambda, options.fit_tolerance, options.max_memory, AffinePart::least_squares,
          guided,         options.max_squeeze};
}

MapFit measured(MapFit fit, const MapProblem& problem, const FitOptions& options) {
  const Points& fitted = problem.registration.fitted_vertices;
  const std::optional<ContactSummary>& contact = problem.registration.summary.contact;
  const std::vector<int>& referenced = problem.pairs.referenced;
  const Points images = (*fit.elastic)(problem.source.vertices);
  fit.summary.vertex_residuals =
      summarize(distances(images(Eigen::all, referenced), fitted(Eigen::all, referenced)));
  if (options.fit_tolerance > 0)
    fit.summary.unmet = unmet_vertices(problem.source, images, fitted, met_within(options),
                                       contact ? contact->released : std::vector<ReleasedVertex>{});
  return fit;
}

MapFit with_steps(MapFit fit, ElasticSteps steps) {
  fit.summary.found = std::move(steps.found.front());
  fit.summary.later_steps.assign(std::make_move_iterator(steps.found.begin() + 1),
                                 std::make_move_iterator(steps.found.end()));
  fit.step_sources = std::move(steps.sources);
  fit.elastic = std::make_shared<const ElasticChain>(std::move(steps.maps));
  return fit;
}

namespace {

/// What is known before anything is fitted.
ElasticSummary summary_of(const MapProblem& problem, const FitOptions& options,
                          const RegionalMotion& motion) {
  ElasticSummary summary;
  summary.method = options.elastic;
  summary.lambda = options.lambda;
  summary.motion = motion;
  summary.unreferenced_vertices = problem.pairs.unreferenced;
  summary.duplicate_vertices = problem.pairs.duplicates;
  summary.anchors_off_surface = problem.anchors_off_surface;
  summary.meets_anchors_off_surface = elastic_method(options.elastic).meets_points;
  return summary;
}

/// Equal steps; where their number is not given, as many as the path's turns require: only it knows those
/// beyond half a one.
StepPlan planned_steps(const MapProblem& problem, const FitOptions& options, int count) {
  StepPlan plan = plan_steps(problem.source, problem.registration.fitted_vertices, problem.pairs, count);
  if (!options.steps) {
    const int required = step_count(plan.path->motion());
    const int finer = std::min(elastic_method(options.elastic).steps_per_required * required,
                               std::max(required, static_cast<int>(max_useful_steps)));
    plan.times = equal_times(std::max(count, finer));
  }
  require_useful_steps(plan.steps(), options);
  return plan;
}

/// A map that is all there is.
ElasticSteps only_step(const MapProblem& problem, ElasticFit fit) {
  return {{std::move(fit.map)}, {std::move(fit.found)}, {problem.source.vertices}};
}

}  // namespace

MapFit fit_steps(const MapProblem& problem, const FitOptions& options, const StepRequest& request,
                 const Progress& progress) {
  const TriangleMesh& source = problem.source;
  const ElasticPairs& pairs = problem.pairs;
  ElasticOptions elastic = elastic_options(options, request.count > 1);
  MapFit fit;
  if (request.count > 1) {
    fit.plan = planned_steps(problem, options, request.count);
    fit.summary = summary_of(problem, options, fit.plan->path->motion());
    ElasticSteps steps = fit_elastic_steps(source, pairs, *fit.plan,
                                           {options.elastic, elastic, request.halve_blocked}, progress);
    fit.plan->times = steps.times;
    fit = with_steps(std::move(fit), std::move(steps));
  } else {
    const Points& fitted = problem.registration.fitted_vertices;
    elastic.growth = power_of_two_scale(growth(source, fitted));
    elastic.give_up_blocked = request.halve_blocked;
    fit.summary = summary_of(problem, options, request.motion);
    fit = with_steps(
        std::move(fit),
        only_step(problem, elastic_method(options.elastic)
                               .fit({source, fitted, pairs.sources, pairs.targets}, elastic, progress)));
  }
  return measured(std::move(fit), problem, options);
}

}  // namespace bespoke
