#include "bespoke/pipeline/elastic_steps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "bespoke/error.h"
#include "bespoke/length.h"
#include "bespoke/mesh/facing_outward.h"

namespace bespoke {
namespace {

/// The source with loose vertices after its own.
Points with_loose(const Points& vertices, const Points& pairs, std::size_t loose) {
  const auto count = static_cast<Eigen::Index>(loose);
  Points all(3, vertices.cols() + count);
  all << vertices, pairs.rightCols(count);
  return all;
}

/// About a middle, which stays.
Points grown(const Points& points, const Vector3& middle, double factor) {
  if (factor == 1) return points;
  return (factor * (points.colwise() - middle)).colwise() + middle;
}

/// Fits one step after the other, from where the points have come to.
class StepFitter {
 public:
  StepFitter(const TriangleMesh& source, const ElasticPairs& pairs, const StepMethod& method,
             const Progress& progress)
      : source_(source),
        vertices_(source.vertices),
        places_(pairs.sources),
        loose_(pairs.anchors_off_surface),
        method_(elastic_method(method.method)),
        options_(method.options),
        progress_(progress) {
    options_.affine_part = AffinePart::similarity;
  }

  void move_by(const ElasticMap& map) {
    vertices_ = map(vertices_);
    places_ = map(places_);
  }

  /// Where a map would take vertices and loose points, one after the other.
  Points moved_by(const ElasticMap& map) const { return map(with_loose(vertices_, places_, loose_)); }

  /// Along the plan, from one time to another, to where the path is then or to `next`: vertices and loose
  /// points.
  void fit_to(const StepPlan& plan, double from, double to) { fit_to(plan, from, to, plan.surface(to)); }
  void fit_to(const StepPlan& plan, double from, double to, const Points& next) {
    add(fit(plan, from, to, next, options_));
  }

  /// The same to where the path is, by a step of a chain. Does nothing and says false where finite elements
  /// are held up and are to give up.
  bool fit_step(const StepPlan& plan, double from, double to, bool give_up) {
    ElasticOptions options = options_;
    // A chain has as many nodes as two maps of one step.
    if (to < plan.times.back()) options.max_nodes /= plan.steps() - 1;
    options.give_up_blocked = give_up;
    ElasticFit found = fit(plan, from, to, plan.surface(to), options);
    if (give_up && is_blocked(found.found)) return false;
    add(std::move(found));
    return true;
  }

  ElasticSteps steps() && { return std::move(steps_); }

 private:
  ElasticFit fit(const StepPlan& plan, double from, double to, const Points& next,
                 ElasticOptions options) const {
    const auto loose = static_cast<Eigen::Index>(loose_);
    const Points fitted = next.leftCols(vertices_.cols());
    const TriangleMesh here{vertices_, source_.faces};
    Points targets = places_;
    targets.leftCols(places_.cols() - loose) = elastic_pairs(source_, fitted).targets;
    targets.rightCols(loose) = next.rightCols(loose);
    options.lambda *= plan.size(from);
    options.growth = plan.size(to) / plan.size(from);
    options.fit_tolerance *= plan.size(to) / plan.size(1);
    return method_.fit({here, fitted, places_, targets}, options, progress_);
  }

  void add(ElasticFit fit) {
    steps_.sources.push_back(vertices_);
    steps_.found.push_back(std::move(fit.found));
    move_by(*fit.map);
    steps_.maps.push_back(std::move(fit.map));
  }

  const TriangleMesh& source_;
  Points vertices_;
  Points places_;
  std::size_t loose_;
  const ElasticMethodRow& method_;
  ElasticOptions options_;
  const Progress& progress_;
  ElasticSteps steps_;
};

/// Similarities in between would hide a mirror image, which no path without folds reaches.
void require_unmirrored(const TriangleMesh& source, const Points& fitted) {
  const std::optional<bool> before = faces_outward(source), after = faces_outward({fitted, source.faces});
  if (before && after && before != after)
    throw InvalidInput(
        "the fitted source is inside out, so one model is a mirror image of the other; mirror it back first");
}

}  // namespace

bool is_blocked(const ElasticFindings& found) {
  const auto* elements = std::get_if<FiniteElementSummary>(&found);
  return elements != nullptr && elements->blocked;
}

StepPlan plan_steps(const TriangleMesh& source, const Points& fitted, const ElasticPairs& pairs, int steps) {
  require_unmirrored(source, fitted);
  StepPlan plan;
  plan.times = equal_times(steps);
  plan.size_scale = power_of_two_scale(growth(source, fitted));
  plan.middle = fitted.rowwise().mean();
  const std::size_t loose = pairs.anchors_off_surface;
  plan.path = std::make_shared<const SurfacePath>(
      TriangleMesh{with_loose(source.vertices, pairs.sources, loose), source.faces},
      grown(with_loose(fitted, pairs.targets, loose), plan.middle, 1 / plan.size_scale));
  return plan;
}

double StepPlan::size(double t) const { return std::pow(size_scale, t); }

Points StepPlan::surface(double t) const { return grown(path->at(t), middle, size(t)); }

std::vector<double> equal_times(int steps) {
  std::vector<double> times;
  for (int k = 0; k <= steps; ++k) times.push_back(static_cast<double>(k) / steps);
  return times;
}

StepPlan halved(const StepPlan& plan, std::size_t step) {
  StepPlan finer = plan;
  const double middle = (plan.times[step] + plan.times[step + 1]) / 2;
  finer.times.insert(finer.times.begin() + static_cast<std::ptrdiff_t>(step) + 1, middle);
  return finer;
}

ElasticSteps fit_elastic_steps(const TriangleMesh& source, const ElasticPairs& pairs, const StepPlan& plan,
                               const StepMethod& method, const Progress& progress) {
  StepFitter fitter(source, pairs, method, progress);
  std::vector<double> times = plan.times;
  std::vector<bool> is_whole(plan.steps(), true);  // no half of a step
  for (std::size_t k = 0; k < is_whole.size();) {
    progress.step("elastic", k, is_whole.size());
    const bool may_halve = method.halve_blocked && is_whole[k] && is_whole.size() < max_useful_steps;
    if (fitter.fit_step(plan, times[k], times[k + 1], may_halve)) {
      ++k;
      continue;
    }
    const auto at = static_cast<std::ptrdiff_t>(k);
    times.insert(times.begin() + at + 1, (times[k] + times[k + 1]) / 2);
    is_whole[k] = false;
    is_whole.insert(is_whole.begin() + at, false);
  }
  ElasticSteps steps = std::move(fitter).steps();
  steps.times = std::move(times);
  return steps;
}

ElasticSteps fit_halves(const TriangleMesh& source, const ElasticPairs& pairs, const HalvedStep& halves,
                        const StepMethod& method, const Progress& progress) {
  const auto& [plan, chain, step] = halves;
  StepFitter fitter(source, pairs, method, progress);
  for (std::size_t k = 0; k < step; ++k) fitter.move_by(*chain.steps()[k]);
  const bool last = step + 1 == chain.steps().size();
  const Points end = last ? plan.surface(1) : fitter.moved_by(*chain.steps()[step]);
  fitter.fit_to(plan, plan.times[step], plan.times[step + 1]);
  fitter.fit_to(plan, plan.times[step + 1], plan.times[step + 2], end);
  return std::move(fitter).steps();
}

}  // namespace bespoke
