#include "bespoke/pipeline/detail/bake_map.h"

#include <optional>
#include <utility>
#include <vector>

#include "bespoke/pipeline/detail/divided_map.h"
#include "bespoke/pipeline/detail/fit_map.h"
#include "bespoke/pipeline/detail/unusable_fit.h"

namespace bespoke {
namespace {

// Of a step and its parts: what folds after those on the path folds however small its motion is.
constexpr int halvings_on_path = 3, halvings_by_layers = 2;

// Of a plan; most have cost a bake that folded.
constexpr std::size_t max_halved_steps = 16;

/// Bakes a chain of planned steps, the last one first. A step that folds, or is predicted to, is halved, as
/// are its halves; the steps after it are kept. Where that makes half as many steps again as were planned,
/// equal steps replace them, the plan's number doubled until they have space (tests/accuracy/tuning.md).
class BakeOfAPlan {
 public:
  BakeOfAPlan(const MapFit& fit, const MapProblem& problem, const MakeMapOptions& options,
              const Progress& progress)
      : fit_(fit),
        problem_(problem),
        options_(options.fit),
        bake_(options.bake),
        progress_(progress),
        has_layers_(bool{elastic_method(options.fit.elastic).composition}) {
    if (fit.plan || may_become_chain())
      max_halvings_ = halvings_on_path + (has_layers_ ? halvings_by_layers : 0);
    begin_plan();
  }

  BakedFit finish() && {
    BakedSteps last;
    for (;;) {
      divide_foreseen(last);
      const std::vector<bool> divisible = divisible_steps();
      BakedSteps baked = bake_steps({*fit_.elastic, fit_.step_sources, problem_.source.faces}, bake_,
                                    {divisible, std::move(last)}, progress_);
      if (!is_to_be_divided(baked, divisible)) return {std::move(fit_), std::move(baked)};
      const std::size_t folded = steps() - baked.steps.size();
      baked.steps.erase(baked.steps.begin());
      baked.summaries.erase(baked.summaries.begin());
      last = std::move(baked);
      divide(folded, last);
    }
  }

 private:
  std::size_t steps() const { return fit_.elastic->steps().size(); }

  /// Whether a single step that folds may become a chain: where neither one step nor its voxels were
  /// requested, and the map itself does not fold.
  bool may_become_chain() const {
    return !options_.steps && !bake_.voxel_size && elastic_method(options_.elastic).keeps_orientation;
  }

  void begin_plan() {
    planned_ = steps();
    halved_ = 0;
    halvings_left_.assign(planned_, max_halvings_);
  }

  std::vector<bool> divisible_steps() const {
    std::vector<bool> divisible;
    for (std::size_t k = 0; k < steps(); ++k)
      divisible.push_back(halvings_left_[k] > 0 && halved_ < max_halved_steps && is_divisible(fit_, k));
    return divisible;
  }

  /// The last of the first `count` steps that is foreseen to fold and may be divided.
  std::optional<std::size_t> foreseen_fold(std::size_t count) const {
    const std::vector<bool> divisible = divisible_steps();
    for (std::size_t k = count; k-- > 0;)
      if (divisible[k] && is_foreseen_to_fold(fit_, k)) return k;
    return std::nullopt;
  }

  /// Steps before those that are baked, so that no time is lost in baking them.
  void divide_foreseen(BakedSteps& baked) {
    while (const std::optional<std::size_t> step = foreseen_fold(steps() - baked.steps.size()))
      divide(*step, baked);
  }

  /// What is baked remains unless all steps are planned anew.
  void divide(std::size_t step, BakedSteps& baked) {
    require_usable(*fit_.elastic, problem_.source, problem_.registration.fitted_vertices, options_);
    if (plan_anew())
      baked = {};
    else
      halve(step);
  }

  /// A single step is halved first: two equal ones are that.
  bool plan_anew() {
    const std::size_t with_one_more = steps() + 1;
    if (steps() == 1 || 2 * with_one_more < 3 * planned_) return false;
    std::size_t count = planned_;
    while (count < with_one_more) count *= 2;
    if (count > max_planned_steps || count == refused_) return false;
    std::optional<MapFit> planned =
        refitted_in_steps(fit_, problem_, options_, static_cast<int>(count), progress_);
    if (!planned) {
      refused_ = count;  // the same would be found after every other fold
      return false;
    }
    fit_ = std::move(*planned);
    begin_plan();
    return true;
  }

  void halve(std::size_t step) {
    const bool leave_path = has_layers_ && halvings_left_[step] <= halvings_by_layers;
    fit_ = divided_map(fit_, {problem_, options_, step, leave_path}, progress_);
    ++halved_;
    const int left = --halvings_left_[step];
    halvings_left_.insert(halvings_left_.begin() + static_cast<std::ptrdiff_t>(step), left);
  }

  MapFit fit_;
  const MapProblem& problem_;
  const FitOptions& options_;
  const BakeOptions& bake_;
  const Progress& progress_;
  bool has_layers_;
  int max_halvings_ = 0;
  std::size_t planned_ = 0;
  std::size_t halved_ = 0;          // of the plan
  std::size_t refused_ = 0;         // steps that would miss their vertices
  std::vector<int> halvings_left_;  // one per step
};

}  // namespace

BakedFit bake_map(const MapFit& fit, const MapProblem& problem, const MakeMapOptions& options,
                  const Progress& progress) {
  BakedFit as_fitted = BakeOfAPlan(fit, problem, options, progress).finish();
  if (as_fitted.baked.whole.relaxed.empty() || as_fitted.baked.steps.size() > 1) return as_fitted;
  // The tolerance comes before guides.
  const std::optional<MapFit> unguided =
      refitted_without_guides(as_fitted.fit, problem, options.fit, progress);
  if (!unguided) return as_fitted;
  BakedFit within = BakeOfAPlan(*unguided, problem, options, progress).finish();
  return within.baked.whole.relaxed.empty() ? within : as_fitted;
}

}  // namespace bespoke
