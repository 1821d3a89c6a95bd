#include "bespoke/registration/detail/register_by_anchors.h"

#include <algorithm>
#include <utility>

#include "bespoke/alignment/geodesic_counterparts.h"
#include "bespoke/alignment/placement.h"
#include "bespoke/anchor_checks/stretching_anchors.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/registration/detail/align_by_anchors.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

/// A registration, and the anchors that it was made by.
struct RegistrationByAnchors {
  Registration registration;
  EstimatedAnchors estimated;        // without those that the fit left out
  std::vector<std::size_t> numbers;  // of the fit's anchors, among those given
};

/// Whether the fit may leave out pairs (SurfaceFitInput).
enum class OutlierTest { fit, none };

/// One flag a pair: whether the fit may leave it out. Pairs with a given accuracy are taken as they are,
/// those of curves and counterparts are no anchors.
std::vector<char> tested_pairs(const RegistrationTask& task, const EstimatedAnchors& estimated,
                               std::size_t count) {
  const std::vector<AnchorPair>& given = task.problem.anchors.pairs;
  std::vector<char> tested(count, 0);
  for (std::size_t k = 0; k < estimated.kept.size(); ++k) {
    const std::size_t number = estimated.kept[k];
    tested[k] = number < given.size() && has_no_given_sigma(given[number]);
  }
  return tested;
}

/// Without the pairs that the fit left out.
EstimatedAnchors without_outliers(EstimatedAnchors estimated, const Registration& registration,
                                  const RegistrationTask& task) {
  std::vector<RejectedAnchor> left_out;
  for (const std::size_t k : registration.summary.surface->outlier_anchors) {
    const AnchorPair& pair = task.problem.anchors.pairs[estimated.kept[k]];
    const Points place = registered_with_source(registration, task.problem.source, Points(pair.a));
    left_out.push_back({estimated.kept[k], (place - pair.b).norm()});
  }
  return without(std::move(estimated), left_out);
}

/// By anchors and by what is known of places far from them: aligned (IV.A, IV.B), then fitted (IV.C).
RegistrationByAnchors register_by_pairs(const RegistrationTask& task, EstimatedAnchors estimated,
                                        const std::vector<AnchorPair>& counterparts, OutlierTest test,
                                        const Progress& progress) {
  std::vector<AnchorPair> leading = task.of_parts;
  leading.insert(leading.end(), counterparts.begin(), counterparts.end());
  AnchorAlignment aligned = align_by_anchors(task.problem, estimated, leading, progress);
  const PointPairs& pairs = aligned.pairs;
  std::vector<char> tested;
  if (test != OutlierTest::none)
    tested = tested_pairs(task, estimated, static_cast<std::size_t>(pairs.sources.cols()));
  SurfaceFit fit =
      fit_surface({task.problem.source, aligned.warped, aligned.target, pairs.sources, pairs.targets,
                   pairs.weights, pairs.sigmas, task.patches.source, task.patches.target, std::move(tested)},
                  task.options, progress);
  Registration registration;
  registration.target_from_source = aligned.target_from_source;
  registration.fitted_vertices = std::move(fit.vertices);
  registration.confidence = std::move(fit.confidence);
  registration.summary.rigid = std::move(aligned.rigid);
  registration.summary.coarse = std::move(aligned.coarse);
  registration.summary.surface = std::move(fit.summary);
  registration.summary.surface_method = task.options.method;
  std::vector<std::size_t> numbers = estimated.kept;
  estimated = without_outliers(std::move(estimated), registration, task);
  return {std::move(registration), std::move(estimated), std::move(numbers)};
}

GeodesicCounterparts remote_counterparts(const RegistrationTask& task, const Anchors& anchors,
                                         const Progress& progress) {
  return geodesic_counterparts(without_excluded(task.problem.source, task.patches.source).mesh,
                               without_excluded(task.problem.target, task.patches.target).mesh,
                               {source_points(anchors), target_points(anchors)}, {}, progress);
}

std::vector<AnchorPair> pairs_of(const GeodesicCounterparts& counterparts, double sigma) {
  std::vector<AnchorPair> pairs(static_cast<std::size_t>(counterparts.sources.cols()));
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    pairs[k].a = counterparts.sources.col(static_cast<Eigen::Index>(k));
    pairs[k].b = counterparts.targets.col(static_cast<Eigen::Index>(k));
    pairs[k].sigma = sigma;
  }
  return pairs;
}

/// Whether the registration may be wrong somewhere: missed parts are uncovered, displaced ones distorted
/// (tests/accuracy/tuning.md).
bool is_suspect(const PlacementFigures& registered) {
  return registered.distortion > 0.15 || registered.covered < 0.99;
}

/// Where some parts of the source are far from all pairs, and came to lie elsewhere than distances along the
/// surfaces put them: registers the source by these too, and keeps that if it explains the target clearly
/// better.
RegistrationByAnchors with_counterparts(const RegistrationTask& task, RegistrationByAnchors by_anchors,
                                        const Progress& progress) {
  constexpr double accuracy = 0.01;        // of the target's diagonal (tests/accuracy/tuning.md)
  constexpr double far_off = 3;            // standard deviations
  constexpr double clearly_better = 0.99;  // ratio of the misfits (tests/accuracy/tuning.md)
  const Stopwatch watch;
  const Registration& registration = by_anchors.registration;
  const EstimatedAnchors& estimated = by_anchors.estimated;
  const GeodesicCounterparts counterparts = remote_counterparts(task, estimated.anchors, progress);
  if (counterparts.sources.cols() == 0) return by_anchors;
  const double sigma = accuracy * diagonal(task.problem.target.vertices);
  const Points places = registered_with_source(registration, task.problem.source, counterparts.sources);
  const auto displaced = ((places - counterparts.targets).colwise().norm().array() > far_off * sigma).count();
  if (displaced < 2) return by_anchors;  // one alone may be mistaken
  const PlacementScore placement(task.problem.source, task.problem.target);
  const PlacementFigures figures = placement(registered_vertices(registration));
  if (!is_suspect(figures)) return by_anchors;

  RegistrationByAnchors trial =
      register_by_pairs(task, estimated, pairs_of(counterparts, sigma), OutlierTest::none, progress);
  const bool taken =
      placement(registered_vertices(trial.registration)).misfit() < clearly_better * figures.misfit();
  RegistrationByAnchors result = std::move(taken ? trial : by_anchors);
  result.registration.summary.counterparts = {static_cast<std::size_t>(counterparts.sources.cols()),
                                              static_cast<std::size_t>(displaced), taken, watch.seconds()};
  return result;
}

/// As if the outliers that a fit by all found had not been given: anew until it finds no more. Where that
/// leaves a suspect result, right pairs may have looked like outliers: then the source is also fitted by all
/// pairs, and the fit that explains the target better is kept.
RegistrationByAnchors refitted_without_outliers(const RegistrationTask& task, const EstimatedAnchors& all,
                                                RegistrationByAnchors fit, const Progress& progress) {
  constexpr int max_rounds = 3;
  for (int round = 0; round < max_rounds && !fit.registration.summary.surface->outlier_anchors.empty();
       ++round)
    fit = register_by_pairs(task, fit.estimated, {}, OutlierTest::fit, progress);
  if (fit.estimated.kept.size() == all.kept.size()) return fit;
  const PlacementScore placement(task.problem.source, task.problem.target);
  const PlacementFigures figures = placement(registered_vertices(fit.registration));
  if (!is_suspect(figures)) return fit;
  RegistrationByAnchors by_all = register_by_pairs(task, all, {}, OutlierTest::none, progress);
  const bool is_better = placement(registered_vertices(by_all.registration)).misfit() < figures.misfit();
  return is_better ? std::move(by_all) : std::move(fit);
}

/// Fitted again where exact pairs that the fit kept contradict each other: by what they differ they need not
/// be met.
RegistrationByAnchors with_shared_contradictions(const RegistrationTask& task, RegistrationByAnchors fit,
                                                 const Progress& progress) {
  EstimatedAnchors shared = fit.estimated;
  const Problem& problem = task.problem;
  let_contradicting_share(shared, problem.anchors.pairs.size(), problem.source, problem.target,
                          task.options.max_stretch);
  if (shared.accuracy.given_way.size() == fit.estimated.accuracy.given_way.size()) return fit;
  return register_by_pairs(task, std::move(shared), {}, OutlierTest::none, progress);
}

/// Of what the pairs alone make suspicious, what the fit did not test: the surfaces explain what it kept.
AnchorAudit unexplained(const Anchors& given, const SurfaceFitSummary& surface) {
  AnchorAudit audit = audit_anchors(given);
  if (!surface.tested_anchors) return audit;
  std::erase_if(audit.suspicious, [&](const SuspiciousAnchor& anchor) {
    return has_no_given_sigma(given.pairs[anchor.index]);
  });
  return audit;
}

/// Without those of curves.
std::vector<double> given_sigmas(const EstimatedAnchors& estimated, const Anchors& given) {
  return {estimated.sigmas.begin(),
          estimated.sigmas.begin() + static_cast<std::ptrdiff_t>(given.pairs.size())};
}

/// What the surface fitting did not meet is not exact for those after it.
EstimatedAnchors with_given_way(RegistrationByAnchors fit, const Anchors& given) {
  EstimatedAnchors estimated = std::move(fit.estimated);
  for (const AnchorGivenWay& anchor : fit.registration.summary.surface->anchors_given_way) {
    if (anchor.index >= fit.numbers.size()) continue;  // a counterpart
    const std::size_t number = fit.numbers[anchor.index];
    const auto kept = std::lower_bound(estimated.kept.begin(), estimated.kept.end(), number);
    estimated.anchors.pairs[static_cast<std::size_t>(kept - estimated.kept.begin())].sigma = anchor.sigma;
    estimated.sigmas[number] = anchor.sigma;
    if (number < given.pairs.size()) estimated.accuracy.given_way.push_back({number, anchor.sigma});
  }
  return estimated;
}

}  // namespace

Points registered_with_source(const Registration& registration, const TriangleMesh& source, const Points& x) {
  const ClosestPointTree tree(source);
  const Points vertices = registered_vertices(registration);
  Points places(3, x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    places.col(i) = carried(*tree.closest(x.col(i)), source.faces, vertices);
  return places;
}

Registration register_by_anchors(const RegistrationTask& task, const Anchors& anchors,
                                 const Progress& progress) {
  const Anchors& given = task.problem.anchors;
  EstimatedAnchors estimated = estimate_anchor_sigmas(anchors, task.problem.source, task.problem.target);
  const bool is_printed = task.options.method != SurfaceFitMethod::deformation_graph;  // takes all pairs
  RegistrationByAnchors best =
      register_by_pairs(task, estimated, {}, is_printed ? OutlierTest::none : OutlierTest::fit, progress);
  if (!is_printed) {
    best = refitted_without_outliers(task, estimated, std::move(best), progress);
    best = with_shared_contradictions(task, std::move(best), progress);
    best = with_counterparts(task, std::move(best), progress);
  }
  Registration result = best.registration;
  CoarseSummary& coarse = *result.summary.coarse;
  coarse.contradicting = contradicting_anchors(given, given_sigmas(best.estimated, given));
  coarse.audit = unexplained(given, *result.summary.surface);
  EstimatedAnchors used = with_given_way(std::move(best), given);
  result.summary.accuracy = std::move(used.accuracy);
  result.anchor_sigma = given_sigmas(used, given);
  result.anchors = std::move(used.anchors);
  return result;
}

}  // namespace bespoke
