#include "bespoke/pipeline/detail/bake_steps.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "bespoke/bake/error_points.h"
#include "bespoke/lattice/atlas_map.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

// Of the whole's tolerance, at the end of the chain, and of its max_face_turn: largest errors of several
// steps rarely meet in one point. And what is aimed at when all are baked again, of the tolerance.
constexpr double tolerance_of_a_step = 0.5;
constexpr double aim = 0.9;

// Of the points at which a whole is measured: the record is that of the whole, steps only search.
constexpr std::size_t share_of_a_step = 10;

// Of the first measurement; the second, of what the first has decided, has other points.
constexpr std::uint64_t first_seed = 31;

/// The steps from `first` on, as a chain.
ElasticChain tail(const ElasticChain& chain, std::size_t first) {
  return ElasticChain({chain.steps().begin() + static_cast<std::ptrdiff_t>(first), chain.steps().end()});
}

/// Where the error is looked at from a step on.
struct ErrorPoints {
  Points band;     ///< anywhere in the step's band
  Points surface;  ///< in its finest cells on the surface
};

ErrorPoints error_points(const MapStep& step, const TriangleMesh& surface, std::size_t count,
                         std::uint64_t seed) {
  if (step.pyramid.levels.empty()) return {Points(3, 0), Points(3, 0)};
  const PyramidLevel& level = step.pyramid.levels.front();
  return {random_points({step.pyramid.origin, level.voxel_size}, level.leaves, count, seed),
          points_in_cells(step.pyramid, finest_cells_on(step.pyramid, surface), count, seed)};
}

/// In BakedSteps::whole. From every step to the end: points of a later band that no earlier one moves are met
/// there.
BakedSteps with_whole_measured(BakedSteps baked, const ExactSteps& exact, const BakeOptions& options,
                               std::uint64_t seed, const Progress& progress) {
  const Stopwatch watch;
  BakeSummary& whole = baked.whole;
  const ElasticChain chain = baked_chain(baked.steps);
  const std::size_t steps = baked.steps.size();
  std::vector<double> errors;
  whole.error_random_points = whole.error_surface_points = 0;
  for (std::size_t k = 0; k < steps; ++k) {
    const std::size_t count = k == 0 ? options.error_points : options.error_points / steps;
    const ErrorPoints points = error_points(baked.steps[k], {exact.surfaces[k], exact.faces}, count, seed);
    for (const Points* x : {&points.band, &points.surface}) {
      const std::vector<double> found =
          displacement_errors(tail(chain, k), tail(exact.chain, k), *x, progress);
      errors.insert(errors.end(), found.begin(), found.end());
    }
    whole.error_random_points += static_cast<std::size_t>(points.band.cols());
    whole.error_surface_points += static_cast<std::size_t>(points.surface.cols());
  }
  whole.error = summarize(std::move(errors));
  whole.tolerance_met = whole.error.max <= options.tolerance;
  whole.measure_seconds += watch.seconds();
  return baked;
}

/// The baked steps after one, looked up as products are: the rounding that this adds is far below a
/// tolerance.
using StepsAfter = std::vector<std::shared_ptr<const ElasticMap>>;

void put_first(const MapStep& step, StepsAfter& after) {
  after.insert(after.begin(), loaded_map(step.affine, step.pyramid));
}

/// One step, its error measured where the baked steps after it take it.
Bake bake_step(const ElasticMap& exact, const TriangleMesh& surface, const StepsAfter& after,
               BakeOptions options, const Progress& progress) {
  options.surface = &surface;
  if (after.empty()) return bake(exact, options, progress);
  const ElasticChain downstream_map(after);
  options.downstream_map = &downstream_map;
  return bake(exact, options, progress);
}

/// The last step first, before `done`, until one folds that may be divided.
BakedSteps bake_all(const ExactSteps& exact, const BakeOptions& options, PartialBake partial,
                    const Progress& progress) {
  BakedSteps baked = std::move(partial.done);
  const std::vector<bool>& divisible = partial.divisible;
  std::size_t used = 0;
  StepsAfter after;
  for (auto step = baked.steps.rbegin(); step != baked.steps.rend(); ++step) {
    used += step->pyramid.leaf_count();
    put_first(*step, after);
  }
  for (std::size_t k = exact.chain.steps().size() - baked.steps.size(); k-- > 0;) {
    const ElasticMap& map = *exact.chain.steps()[k];
    BakeOptions step_options = options;
    // Steps that need less leave it to those before them; a share is kept in case one is divided.
    const std::size_t shares = k + (k > 0 && !divisible.empty() ? 2 : 1);
    if (options.max_leaves)
      step_options.max_leaves = (*options.max_leaves - std::min(*options.max_leaves, used)) / shares;
    Bake step = bake_step(map, {exact.surfaces[k], exact.faces}, after, step_options, progress);
    used += step.pyramid.leaf_count();
    baked.steps.insert(baked.steps.begin(),
                       {map.affine(), std::move(step.pyramid), std::move(step.certificate)});
    baked.summaries.insert(baked.summaries.begin(), std::move(step.summary));
    if (is_to_be_divided(baked, divisible)) break;
    if (k > 0) put_first(baked.steps.front(), after);
  }
  return baked;
}

/// Whether all steps do what they were requested, and are allowed more leaves.
bool finer_steps_help(const BakedSteps& baked, const BakeOptions& options) {
  std::size_t leaves = 0;
  for (const MapStep& step : baked.steps) leaves += step.pyramid.leaf_count();
  const bool met = std::all_of(baked.summaries.begin(), baked.summaries.end(),
                               [](const BakeSummary& summary) { return summary.tolerance_met; });
  return met && leaves < options.max_leaves.value_or(4 * leaves) / 2;
}

/// Whether a step that misses its tolerance has less than half of an even share of the leaves
/// (tests/accuracy/tuning.md).
bool has_starved_step(const BakedSteps& baked, std::size_t max_leaves) {
  const std::size_t share = max_leaves / baked.steps.size();
  for (std::size_t k = 0; k < baked.steps.size(); ++k)
    if (!baked.summaries[k].tolerance_met && baked.steps[k].pyramid.leaf_count() < share / 2) return true;
  return false;
}

/// Whether every step is stored without an error, as maps on lattices are: then so is the whole.
bool is_exact(const BakedSteps& baked) {
  return std::all_of(baked.summaries.begin(), baked.summaries.end(),
                     [](const BakeSummary& summary) { return summary.error.count == 0; });
}

bool is_bijection(const BakedSteps& baked) {
  return std::all_of(baked.steps.begin(), baked.steps.end(),
                     [](const MapStep& step) { return step.certificate.is_bijection(); });
}

}  // namespace

bool is_to_be_divided(const BakedSteps& baked, const std::vector<bool>& divisible) {
  if (baked.steps.empty() || divisible.empty()) return false;
  const std::size_t first = divisible.size() - baked.steps.size();
  return divisible[first] && !baked.steps.front().certificate.is_bijection();
}

void add_step(const BakeSummary& step, BakeSummary& whole) {
  whole.levels.insert(whole.levels.end(), step.levels.begin(), step.levels.end());
  whole.relaxed.insert(whole.relaxed.end(), step.relaxed.begin(), step.relaxed.end());
  whole.error_random_points += step.error_random_points;
  whole.error_surface_points += step.error_surface_points;
  whole.surface_cells += step.surface_cells;
  whole.misoriented_faces += step.misoriented_faces;
  whole.refined_folds += step.refined_folds;
  whole.repaired_cells += step.repaired_cells;
  whole.repair_cost = std::max(whole.repair_cost, step.repair_cost);
  whole.folded_cells += step.folded_cells;
  whole.evaluated_points += step.evaluated_points;
  whole.peak_bytes = std::max(whole.peak_bytes, step.peak_bytes);
  whole.refine_seconds += step.refine_seconds;
  whole.measure_seconds += step.measure_seconds;
  whole.repair_seconds += step.repair_seconds;
}

BakedSteps bake_steps(const ExactSteps& exact, const BakeOptions& options, PartialBake partial,
                      const Progress& progress) {
  const std::vector<bool> divisible = partial.divisible;
  if (exact.chain.steps().size() == 1) {
    BakedSteps baked = bake_all(exact, options, std::move(partial), progress);
    if (!is_to_be_divided(baked, divisible)) baked.whole = baked.summaries.front();
    return baked;
  }
  const Stopwatch watch;
  const bool was_divided = !partial.done.steps.empty();
  BakeOptions step_options = options;
  step_options.tolerance = tolerance_of_a_step * options.tolerance;
  step_options.max_face_turn = tolerance_of_a_step * options.max_face_turn;
  step_options.error_points = std::max<std::size_t>(1, options.error_points / share_of_a_step);
  BakedSteps baked;
  for (const bool again : {false, true}) {
    baked = bake_all(exact, step_options, again ? PartialBake{} : std::move(partial), progress);
    if (!again && is_to_be_divided(baked, divisible)) return baked;
    if (!again && was_divided && options.max_leaves && has_starved_step(baked, *options.max_leaves)) {
      BakedSteps even = bake_all(exact, step_options, {}, progress);
      if (is_bijection(even)) baked = std::move(even);
    }
    for (const BakeSummary& summary : baked.summaries) add_step(summary, baked.whole);
    if (is_exact(baked)) {
      baked.whole.tolerance_met = true;
      break;
    }
    baked =
        with_whole_measured(std::move(baked), exact, options, again ? first_seed + 1 : first_seed, progress);
    if (baked.whole.tolerance_met || !finer_steps_help(baked, options)) break;
    step_options.tolerance *= aim * options.tolerance / baked.whole.error.max;
  }
  baked.whole.seconds = watch.seconds();
  return baked;
}

}  // namespace bespoke
