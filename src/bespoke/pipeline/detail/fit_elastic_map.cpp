#include "bespoke/pipeline/detail/fit_elastic_map.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/length.h"
#include "bespoke/pipeline/detail/hopeless_fit.h"
#include "bespoke/pipeline/elastic_pairs.h"
#include "bespoke/stopwatch.h"

namespace bespoke {

std::vector<double> anchor_residuals(const FittedMapping& fitted, const Anchors& anchors) {
  return distances(fitted.target_from_source * (*fitted.elastic)(source_points(anchors)),
                   target_points(anchors));
}

namespace {

/// What the elastic map is fitted to, with the anchors that the surface does not carry.
ElasticPairs pairs_for_elastic(const FittedMapping& fitted, const TriangleMesh& source,
                               const Anchors& anchors, const FitOptions& options, ElasticSummary& summary) {
  // A vertex and an anchor closer than this ask an interpolating map for differences of rounding errors.
  constexpr double min_distance = 1e-6;  // of the source's diagonal
  const double tolerance = options.fit_tolerance / power_of_two_scale(growth(source, fitted.fitted_vertices));
  const double off_surface = std::max(tolerance, min_distance * diagonal(source.vertices));
  const std::vector<std::size_t> off = anchors_off_surface(source, anchors, off_surface);
  ElasticPairs pairs = elastic_pairs(source, fitted.fitted_vertices);
  summary.unreferenced_vertices = pairs.unreferenced;
  summary.duplicate_vertices = pairs.duplicates;
  summary.anchors_off_surface = off.size();
  summary.meets_anchors_off_surface = elastic_method(options.elastic).meets_points;
  if (off.empty() || !summary.meets_anchors_off_surface) return pairs;
  return with_anchors(std::move(pairs), anchors, off, inverse(fitted.target_from_source));
}

/// By how much a vertex may be missed before it is listed, mesh units.
double met_within(const FitOptions& options) {
  return elastic_method(options.elastic).met_within * options.fit_tolerance;
}

/// What can be said only with the whole map at hand.
void measure_residuals(FittedMapping& result, const TriangleMesh& source, const Anchors& anchors,
                       const FitOptions& options) {
  ElasticSummary& summary = result.summary.elastic;
  const ElasticMap& elastic = *result.elastic;
  const std::vector<int>& referenced = result.pairs.referenced;
  const Points images = elastic(source.vertices);
  summary.vertex_residuals =
      summarize(distances(images(Eigen::all, referenced), result.fitted_vertices(Eigen::all, referenced)));
  if (options.fit_tolerance > 0)
    summary.unmet = unmet_vertices(
        source, images, result.fitted_vertices, met_within(options),
        result.summary.contact ? result.summary.contact->released : std::vector<ReleasedVertex>{});
  result.anchor_residual = anchor_residuals(result, anchors);
  summary.anchor_residuals = summarize(result.anchor_residual);
}

/// Of a map that is all there is, or of the steps of a chain.
ElasticOptions elastic_options(const FitOptions& options, bool of_steps) {
  const bool guided = options.guides == GuidedMaps::all || (of_steps && options.guides == GuidedMaps::steps);
  ElasticOptions elastic{options.lambda, options.fit_tolerance, options.max_memory, AffinePart::least_squares,
                         guided,         options.max_squeeze};
  elastic.give_up_blocked = options.give_up_blocked;
  return elastic;
}

void take_steps(FittedMapping& result, ElasticSteps steps) {
  ElasticSummary& summary = result.summary.elastic;
  summary.found = std::move(steps.found.front());
  summary.later_steps.assign(std::make_move_iterator(steps.found.begin() + 1),
                             std::make_move_iterator(steps.found.end()));
  result.step_sources = std::move(steps.sources);
  result.elastic = std::make_shared<const ElasticChain>(std::move(steps.maps));
}

/// The elastic map as a chain of so many steps along surfaces between the two, or as one.
void fit_steps(FittedMapping& result, const TriangleMesh& source, const Anchors& anchors,
               const FitOptions& options, int count, const Progress& progress) {
  if (count > 1) {
    result.plan = plan_steps(source, result.fitted_vertices, result.pairs, count);
    // Only the path knows turns beyond half a one.
    const RegionalMotion motion = result.plan->path->motion();
    if (!options.steps) result.plan->times = equal_times(std::max(count, step_count(motion)));
    require_useful_steps(result.plan->steps(), options);
    result.summary.elastic.motion = motion;
    take_steps(result, fit_elastic_steps(source, result.pairs, *result.plan, options.elastic,
                                         elastic_options(options, true), progress));
  } else {
    ElasticOptions whole = elastic_options(options, false);
    whole.growth = power_of_two_scale(growth(source, result.fitted_vertices));
    ElasticFit fit = elastic_method(options.elastic)
                         .fit({source, result.fitted_vertices, result.pairs.sources, result.pairs.targets},
                              whole, progress);
    take_steps(result, {{std::move(fit.map)}, {std::move(fit.found)}, {source.vertices}});
  }
  measure_residuals(result, source, anchors, options);
}

/// Parts that slide along each other neither turn nor stretch, but shear the space between them. Layers that
/// do not fold cannot follow where that is too steep: where more than one vertex in a hundred is missed there
/// are twice as many steps, for as long as that halves what is missed.
void divide_where_missed(FittedMapping& result, const TriangleMesh& source, const Anchors& anchors,
                         const FitOptions& options, const Progress& progress) {
  const auto missed = [](const FittedMapping& fit) { return fit.summary.elastic.vertex_residuals.p99; };
  while (missed(result) > options.fit_tolerance && 2 * result.elastic->steps().size() <= max_useful_steps) {
    FittedMapping finer = result;
    fit_steps(finer, source, anchors, options, 2 * static_cast<int>(result.elastic->steps().size()),
              progress);
    const double before = missed(result), after = missed(finer);
    if (after < before) {
      result = std::move(finer);
      result.summary.elastic.divided_where_missed = true;
    }
    if (after > before / 2) return;
  }
}

std::size_t blocked_steps(const FittedMapping& fitted) {
  const auto is_blocked = [](const ElasticFindings& found) {
    const auto* elements = std::get_if<FiniteElementSummary>(&found);
    return elements != nullptr && elements->blocked;
  };
  const ElasticSummary& summary = fitted.summary.elastic;
  return static_cast<std::size_t>(
             std::count_if(summary.later_steps.begin(), summary.later_steps.end(), is_blocked)) +
         (is_blocked(summary.found) ? 1 : 0);
}

/// Where cells at their bounds hold finite elements up, motion is too large for a step: twice as many steps
/// take its place, for as long as fewer of them are held up. Where they are not, places give way.
void fit_unblocked(FittedMapping& result, const TriangleMesh& source, const Anchors& anchors,
                   const FitOptions& options, int count, const Progress& progress) {
  FitOptions giving_up = options;
  giving_up.give_up_blocked = true;
  std::size_t before = 0;
  for (int steps = count; static_cast<std::size_t>(steps) <= max_useful_steps; steps *= 2) {
    fit_steps(result, source, anchors, giving_up, steps, progress);
    const std::size_t blocked = blocked_steps(result);
    if (blocked == 0) return;
    if (steps > count && 2 * blocked > before) break;
    before = blocked;
    count = static_cast<int>(result.elastic->steps().size());
    steps = count;
  }
  fit_steps(result, source, anchors, options, count, progress);
}

/// One map or a chain of as many steps as the motion requires, more where they miss vertices. Takes the place
/// of one that there is.
void fit_as_asked(FittedMapping& result, const TriangleMesh& source, const Anchors& anchors,
                  const FitOptions& options, const Progress& progress) {
  ElasticSummary& summary = result.summary.elastic;
  summary.motion = regional_motion(source, result.fitted_vertices);
  summary.divided_where_missed = false;
  result.plan.reset();
  const int count = options.steps.value_or(step_count(summary.motion));
  if (options.elastic == ElasticMethod::finite_elements && !options.steps)
    return fit_unblocked(result, source, anchors, options, count, progress);
  fit_steps(result, source, anchors, options, count, progress);
  const bool follows = elastic_method(options.elastic).composition && options.fit_tolerance > 0;
  if (follows && !options.steps) divide_where_missed(result, source, anchors, options, progress);
}

FitOptions without_guides(FitOptions options) {
  options.guides = GuidedMaps::none;
  return options;
}

bool is_guided(const FittedMapping& fitted, const FitOptions& options) {
  return elastic_method(options.elastic).takes_guides && !fitted.summary.elastic.left_guides &&
         elastic_options(options, fitted.elastic->steps().size() > 1).guided;
}

/// The surface comes first: where parts slide along each other, space between them cannot go with both.
void leave_guides_that_harm(FittedMapping& fitted, const TriangleMesh& source, const Anchors& anchors,
                            const FitOptions& options, const Progress& progress) {
  const auto missed = [](const FittedMapping& fit) { return fit.summary.elastic.vertex_residuals.p99; };
  if (elastic_method(options.elastic).weighs_guides || !(missed(fitted) > met_within(options))) return;
  std::optional<FittedMapping> unguided = refitted_without_guides(fitted, source, anchors, options, progress);
  if (unguided && missed(*unguided) < missed(fitted)) fitted = std::move(*unguided);
}

/// Whether no more than one vertex in twenty is missed.
bool follows_fit(const FittedMapping& fitted, const FitOptions& options) {
  return fitted.summary.elastic.vertex_residuals.p95 <= met_within(options);
}

/// Whether steps are, or would be, along surfaces in between.
bool follows_path(const FittedMapping& fitted) { return fitted.plan || fitted.elastic->steps().size() == 1; }

/// A step that is a composition, in two: the same map, for which nothing is fitted anew.
ElasticSteps in_two_by_layers(const FittedMapping& fitted, std::size_t step) {
  const ElasticSummary& summary = fitted.summary.elastic;
  auto [first, second] = elastic_method(summary.method)
                             .composition.halves({fitted.elastic->steps()[step],
                                                  step == 0 ? summary.found : summary.later_steps[step - 1]});
  const Points& begin = fitted.step_sources[step];
  const Points middle = (*first.map)(begin);
  return {{std::move(first.map), std::move(second.map)},
          {std::move(first.found), std::move(second.found)},
          {begin, middle}};
}

void put_in_place(FittedMapping& fitted, std::size_t step, ElasticSteps halves) {
  ElasticSummary& summary = fitted.summary.elastic;
  const std::vector<std::shared_ptr<const ElasticMap>>& maps = fitted.elastic->steps();
  ElasticSteps steps;
  for (std::size_t k = 0; k < maps.size(); ++k) {
    for (std::size_t half = 0; half < (k == step ? 2 : 0); ++half) {
      steps.maps.push_back(std::move(halves.maps[half]));
      steps.found.push_back(std::move(halves.found[half]));
      steps.sources.push_back(std::move(halves.sources[half]));
    }
    if (k == step) continue;
    steps.maps.push_back(maps[k]);
    steps.found.push_back(k == 0 ? summary.found : summary.later_steps[k - 1]);
    steps.sources.push_back(fitted.step_sources[k]);
  }
  take_steps(fitted, std::move(steps));
}

/// The map with a step in two along the path, each fitted anew.
FittedMapping halved_on_path(const FittedMapping& fitted, const TriangleMesh& source, const Anchors& anchors,
                             const FitOptions& options, std::size_t step, const Progress& progress) {
  FittedMapping result = fitted;
  if (!result.plan) result.plan = plan_steps(source, result.fitted_vertices, result.pairs, 1);
  result.plan = halved(*result.plan, step);
  const FitOptions taken = result.summary.elastic.left_guides ? without_guides(options) : options;
  put_in_place(result, step,
               fit_halves(source, result.pairs, *result.plan, *result.elastic, step, options.elastic,
                          elastic_options(taken, true), progress));
  measure_residuals(result, source, anchors, options);
  return result;
}

void part_by_layers(FittedMapping& fitted, const TriangleMesh& source, const Anchors& anchors,
                    const FitOptions& options, std::size_t step) {
  put_in_place(fitted, step, in_two_by_layers(fitted, step));
  fitted.plan.reset();
  measure_residuals(fitted, source, anchors, options);
}

}  // namespace

void fit_elastic_map(FittedMapping& result, const TriangleMesh& source, const Anchors& anchors,
                     const FitOptions& options, const Progress& progress) {
  const Stopwatch watch;
  progress.step("elastic", 0, 0);
  ElasticSummary& summary = result.summary.elastic;
  result.pairs = pairs_for_elastic(result, source, anchors, options, summary);
  summary.method = options.elastic;
  summary.lambda = options.lambda;
  fit_as_asked(result, source, anchors, options, progress);
  leave_guides_that_harm(result, source, anchors, options, progress);
  summary.seconds = watch.seconds();
}

std::optional<FittedMapping> refitted_without_guides(const FittedMapping& fitted, const TriangleMesh& source,
                                                     const Anchors& anchors, const FitOptions& options,
                                                     const Progress& progress) {
  if (!is_guided(fitted, options)) return std::nullopt;
  const Stopwatch watch;
  FittedMapping result = fitted;
  fit_as_asked(result, source, anchors, without_guides(options), progress);
  result.summary.elastic.left_guides = true;
  result.summary.elastic.seconds += watch.seconds();
  return result;
}

std::optional<FittedMapping> refitted_in_steps(const FittedMapping& fitted, const TriangleMesh& source,
                                               const Anchors& anchors, const FitOptions& options, int count,
                                               const Progress& progress) {
  const Stopwatch watch;
  FittedMapping result = fitted;
  const FitOptions taken = fitted.summary.elastic.left_guides ? without_guides(options) : options;
  fit_steps(result, source, anchors, taken, count, progress);
  if (!follows_fit(result, options)) return std::nullopt;
  ++result.summary.elastic.divided_steps;
  result.summary.elastic.seconds += watch.seconds();
  return result;
}

bool is_divisible(const FittedMapping& fitted, std::size_t step) {
  const CompositionOfMaps& composition = elastic_method(fitted.summary.elastic.method).composition;
  return !composition || composition.parts(*fitted.elastic->steps().at(step)) > 1;
}

bool is_foreseen_to_fold(const FittedMapping& fitted, std::size_t step) {
  // Steps beyond it mostly fold when baked (tests/accuracy/tuning.md). Maps of fewer scales are smooth,
  // however many layers they take.
  constexpr double max_layers_a_scale = 2.5;
  constexpr std::size_t usual_scales = 6;
  const CompositionOfMaps& composition = elastic_method(fitted.summary.elastic.method).composition;
  const std::shared_ptr<const ElasticMap>& map = fitted.elastic->steps().at(step);
  if (!composition) return false;
  std::size_t scales = usual_scales;
  for (const auto& each : fitted.elastic->steps()) scales = std::max(scales, composition.scales(*each));
  return static_cast<double>(composition.parts(*map)) > max_layers_a_scale * static_cast<double>(scales);
}

void divide_step(FittedMapping& fitted, const TriangleMesh& source, const Anchors& anchors,
                 const FitOptions& options, std::size_t step, bool leave_path, const Progress& progress) {
  if (step >= fitted.elastic->steps().size() || !is_divisible(fitted, step))
    throw InvalidInput("there is no such step to divide");
  const Stopwatch watch;
  const double seconds = fitted.summary.elastic.seconds;
  bool follows = !elastic_method(options.elastic).composition;
  if (follows || (follows_path(fitted) && !leave_path)) {
    FittedMapping on_path = halved_on_path(fitted, source, anchors, options, step, progress);
    follows = follows || follows_fit(on_path, options);
    if (follows) fitted = std::move(on_path);
  }
  if (!follows) part_by_layers(fitted, source, anchors, options, step);
  ++fitted.summary.elastic.divided_steps;
  fitted.summary.elastic.seconds = seconds + watch.seconds();
}

}  // namespace bespoke
