#include "bespoke/pipeline/detail/fit_map.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "bespoke/pipeline/detail/fit_steps.h"
#include "bespoke/pipeline/detail/unusable_fit.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

std::size_t step_count(const MapFit& fit) { return fit.elastic->steps().size(); }

/// One vertex in a hundred is missed by more, mesh units.
double missed(const MapFit& fit) { return fit.summary.vertex_residuals.p99; }

/// Parts that slide along each other neither turn nor stretch, but shear the space between them. Layers that
/// do not fold cannot follow where that is too steep: where more than one vertex in a hundred is missed there
/// are twice as many steps, for as long as that halves what is missed.
MapFit fit_until_met(const MapProblem& problem, const FitOptions& options, const StepRequest& request,
                     const Progress& progress) {
  MapFit fit = fit_steps(problem, options, request, progress);
  while (missed(fit) > options.fit_tolerance && 2 * step_count(fit) <= max_useful_steps) {
    const int twice = 2 * static_cast<int>(step_count(fit));
    MapFit finer = fit_steps(problem, options, {twice, fit.summary.motion}, progress);
    const double before = missed(fit), after = missed(finer);
    if (after < before) {
      fit = std::move(finer);
      fit.summary.divided_where_missed = true;
    }
    if (after > before / 2) break;
  }
  return fit;
}

std::size_t blocked_steps(const MapFit& fit) {
  const std::vector<ElasticFindings>& later = fit.summary.later_steps;
  return static_cast<std::size_t>(std::count_if(later.begin(), later.end(), is_blocked)) +
         (is_blocked(fit.summary.found) ? 1 : 0);
}

/// Where cells at their bounds hold finite elements up, motion is too large for a step: those of a chain are
/// halved before places give way. A single step becomes a chain if none of that is held up.
MapFit fit_unblocked(const MapProblem& problem, const FitOptions& options, const StepRequest& request,
                     const Progress& progress) {
  MapFit fit = fit_steps(problem, options, {request.count, request.motion, true}, progress);
  if (step_count(fit) > 1 || !is_blocked(fit.summary.found)) return fit;
  MapFit chain = fit_steps(problem, options, {2, request.motion}, progress);
  return blocked_steps(chain) == 0 ? chain : fit_steps(problem, options, request, progress);
}

/// One map or a chain of as many steps as the motion requires.
StepRequest required_steps(const MapProblem& problem, const FitOptions& options) {
  const RegionalMotion motion = regional_motion(problem.source, problem.registration.fitted_vertices);
  return {options.steps.value_or(bespoke::step_count(motion)), motion};
}

/// The loop that finds how many steps there are: none where that is given.
auto* fit_of(const FitOptions& options) {
  if (options.steps) return &fit_steps;
  const ElasticMethodRow& method = elastic_method(options.elastic);
  if (method.steps_per_required > 1) return &fit_unblocked;
  return method.composition && options.fit_tolerance > 0 ? &fit_until_met : &fit_steps;
}

bool is_guided(const MapFit& fit, const FitOptions& options) {
  return elastic_method(options.elastic).takes_guides && !fit.summary.left_guides &&
         elastic_options(options, step_count(fit) > 1).guided;
}

}  // namespace

MapFit fit_map(const MapProblem& problem, const FitOptions& options, const Progress& progress) {
  const bool is_registered = problem.registration.summary.surface.has_value();  // not given as it is
  const Points& fitted = problem.registration.fitted_vertices;
  if (is_registered) require_usable_surface(problem.source, fitted, options);
  const Stopwatch watch;
  progress.step("elastic", 0, 0);
  MapFit fit = fit_of(options)(problem, options, required_steps(problem, options), progress);
  // The surface comes first: where parts slide along each other, space between them cannot go with both.
  if (!elastic_method(options.elastic).weighs_guides && missed(fit) > met_within(options)) {
    std::optional<MapFit> unguided = refitted_without_guides(fit, problem, options, progress);
    if (unguided && missed(*unguided) < missed(fit)) fit = std::move(*unguided);
  }
  fit.summary.seconds = watch.seconds();
  if (is_registered) require_usable(*fit.elastic, problem.source, fitted, options);
  return fit;
}

std::optional<MapFit> refitted_without_guides(const MapFit& fit, const MapProblem& problem,
                                              const FitOptions& options, const Progress& progress) {
  if (!is_guided(fit, options)) return std::nullopt;
  const Stopwatch watch;
  MapFit unguided =
      fit_of(options)(problem, without_guides(options), required_steps(problem, options), progress);
  unguided.summary.left_guides = true;
  unguided.summary.divided_steps = fit.summary.divided_steps;
  unguided.summary.seconds = fit.summary.seconds + watch.seconds();
  return unguided;
}

}  // namespace bespoke
