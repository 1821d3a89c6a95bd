#include "bespoke/pipeline/detail/divided_map.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/pipeline/detail/fit_steps.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

/// Whether steps are, or would be, along surfaces in between.
bool follows_path(const MapFit& fit) { return fit.plan || fit.elastic->steps().size() == 1; }

const ElasticFindings& findings(const MapFit& fit, std::size_t step) {
  return step == 0 ? fit.summary.found : fit.summary.later_steps[step - 1];
}

/// A step that is a composition, in two: the same map, for which nothing is fitted anew.
ElasticSteps in_two_by_layers(const MapFit& fit, std::size_t step) {
  auto [first, second] = elastic_method(fit.summary.method)
                             .composition.halves({fit.elastic->steps()[step], findings(fit, step)});
  const Points& begin = fit.step_sources[step];
  const Points middle = (*first.map)(begin);
  return {{std::move(first.map), std::move(second.map)},
          {std::move(first.found), std::move(second.found)},
          {begin, middle}};
}

MapFit with_halves(const MapFit& fit, std::size_t step, ElasticSteps halves) {
  ElasticSteps steps;
  for (std::size_t k = 0; k < fit.elastic->steps().size(); ++k) {
    for (std::size_t half = 0; half < (k == step ? 2 : 0); ++half) {
      steps.maps.push_back(std::move(halves.maps[half]));
      steps.found.push_back(std::move(halves.found[half]));
      steps.sources.push_back(std::move(halves.sources[half]));
    }
    if (k == step) continue;
    steps.maps.push_back(fit.elastic->steps()[k]);
    steps.found.push_back(findings(fit, k));
    steps.sources.push_back(fit.step_sources[k]);
  }
  return with_steps(fit, std::move(steps));
}

/// The map with a step in two along the path, each fitted anew.
MapFit halved_on_path(const MapFit& fit, const StepDivision& division, const Progress& progress) {
  const auto& [problem, options, step, leave_path] = division;
  const StepPlan whole =
      fit.plan ? *fit.plan
               : plan_steps(problem.source, problem.registration.fitted_vertices, problem.pairs, 1);
  StepPlan plan = halved(whole, step);
  const FitOptions taken = fit.summary.left_guides ? without_guides(options) : options;
  const HalvedStep halves{plan, *fit.elastic, step};
  MapFit result = with_halves(fit, step,
                              fit_halves(problem.source, problem.pairs, halves,
                                         {options.elastic, elastic_options(taken, true)}, progress));
  result.plan = std::move(plan);
  return measured(std::move(result), problem, options);
}

MapFit parted_by_layers(const MapFit& fit, const StepDivision& division) {
  MapFit result = with_halves(fit, division.step, in_two_by_layers(fit, division.step));
  result.plan.reset();
  return measured(std::move(result), division.problem, division.options);
}

MapFit halved_map(const MapFit& fit, const StepDivision& division, const Progress& progress) {
  const bool has_layers = bool{elastic_method(division.options.elastic).composition};
  if (!has_layers) return halved_on_path(fit, division, progress);
  if (follows_path(fit) && !division.leave_path) {
    MapFit on_path = halved_on_path(fit, division, progress);
    if (follows_fit(on_path, division.options)) return on_path;
  }
  return parted_by_layers(fit, division);
}

}  // namespace

bool is_divisible(const MapFit& fit, std::size_t step) {
  const CompositionOfMaps& composition = elastic_method(fit.summary.method).composition;
  return !composition || composition.parts(*fit.elastic->steps().at(step)) > 1;
}

bool is_foreseen_to_fold(const MapFit& fit, std::size_t step) {
  // Steps beyond it mostly fold when baked (tests/accuracy/tuning.md). Maps of fewer scales are smooth,
  // however many layers they take.
  constexpr double max_layers_a_scale = 2.5;
  constexpr std::size_t usual_scales = 6;
  const CompositionOfMaps& composition = elastic_method(fit.summary.method).composition;
  const std::shared_ptr<const ElasticMap>& map = fit.elastic->steps().at(step);
  if (!composition) return false;
  std::size_t scales = usual_scales;
  for (const auto& each : fit.elastic->steps()) scales = std::max(scales, composition.scales(*each));
  return static_cast<double>(composition.parts(*map)) > max_layers_a_scale * static_cast<double>(scales);
}

MapFit divided_map(const MapFit& fit, const StepDivision& division, const Progress& progress) {
  if (division.step >= fit.elastic->steps().size() || !is_divisible(fit, division.step))
    throw InvalidInput("there is no such step to divide");
  const Stopwatch watch;
  MapFit result = halved_map(fit, division, progress);
  ++result.summary.divided_steps;
  result.summary.seconds = fit.summary.seconds + watch.seconds();
  return result;
}

std::optional<MapFit> refitted_in_steps(const MapFit& fit, const MapProblem& problem,
                                        const FitOptions& options, int count, const Progress& progress) {
  const Stopwatch watch;
  const FitOptions taken = fit.summary.left_guides ? without_guides(options) : options;
  MapFit result = fit_steps(problem, taken, {count, fit.summary.motion}, progress);
  if (!follows_fit(result, options)) return std::nullopt;
  result.summary.left_guides = fit.summary.left_guides;
  result.summary.divided_where_missed = fit.summary.divided_where_missed;
  result.summary.divided_steps = fit.summary.divided_steps + 1;
  result.summary.seconds = fit.summary.seconds + watch.seconds();
  return result;
}

}  // namespace bespoke
