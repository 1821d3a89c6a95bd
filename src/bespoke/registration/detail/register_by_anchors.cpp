#include "bespoke/registration/detail/register_by_anchors.h"

#include <algorithm>
#include <utility>

#include "bespoke/alignment/geodesic_counterparts.h"
#include "bespoke/alignment/placement.h"
#include "bespoke/anchor_checks/stretching_anchors.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/registration/detail/align_by_anchors.h"
#include "bespoke/registration/detail/anchor_outliers.h"
#include "bespoke/registration/detail/rejected_anchors.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

/// By anchors and by what is known of places far from them: aligned (IV.A, IV.B), then fitted (IV.C).
Registration register_by_pairs(const RegistrationTask& task, const EstimatedAnchors& estimated,
                               const std::vector<AnchorPair>& counterparts, const Progress& progress) {
  std::vector<AnchorPair> leading = task.of_parts;
  leading.insert(leading.end(), counterparts.begin(), counterparts.end());
  AnchorAlignment aligned = align_by_anchors(task.problem, estimated, leading, progress);
  const PointPairs& pairs = aligned.pairs;
  SurfaceFit fit =
      fit_surface({task.problem.source, aligned.warped, aligned.target, pairs.sources, pairs.targets,
                   pairs.weights, pairs.sigmas, task.patches.source, task.patches.target},
                  task.options, progress);
  Registration registration;
  registration.target_from_source = aligned.target_from_source;
  registration.fitted_vertices = std::move(fit.vertices);
  registration.confidence = std::move(fit.confidence);
  registration.summary.rigid = std::move(aligned.rigid);
  registration.summary.coarse = std::move(aligned.coarse);
  registration.summary.surface = std::move(fit.summary);
  registration.summary.surface_method = task.options.method;
  return registration;
}

/// A registration, and the anchors that it was made by.
struct RegistrationByAnchors {
  Registration registration;
  EstimatedAnchors estimated;
};

/// The source registered by its estimated pairs without some of them.
struct RegistrationTrial {
  const RegistrationTask& task;
  const EstimatedAnchors& estimated;
  const AnchorOutlierTest& outlier_test;
  const Progress& progress;
  Registration registered;  // the last

  /// Those of the pairs left out that the surfaces then displace.
  std::vector<RejectedAnchor> register_without(const std::vector<std::size_t>& left_out) {
    std::vector<RejectedAnchor> all;
    for (const std::size_t index : left_out) all.push_back({index, 0});
    registered = register_by_pairs(task, without(estimated, all), {}, progress);
    return outlier_test.displaced_pairs(registered_vertices(registered), left_out);
  }
};

/// What tells outliers.
struct OutlierSigns {
  const AnchorOutlierTest& test;
  const AnchorAudit& audit;
  const std::vector<std::size_t>& suspects;
};

/// Registers the source without the pairs that the surfaces then displace, and keeps that if it explains the
/// target no worse than by all. Where it explains it worse, right pairs may have been rejected beside wrong
/// ones: then each of a few is tested alone. Of a few rejected pairs those are reinstated that are no
/// suspects, and with which the target is explained no worse, without the others.
RegistrationByAnchors register_by_inliers(const RegistrationTask& task, const RegistrationByAnchors& by_all,
                                          const OutlierSigns& signs, const Progress& progress) {
  constexpr std::size_t few = 6;  // each is a surface fitting
  RegistrationTrial trial{task, by_all.estimated, signs.test, progress, by_all.registration};
  const RejectAnchors reject = [&](const auto& left_out) { return trial.register_without(left_out); };
  const PlacementScore placement(task.problem.source, task.problem.target);
  const auto misfit = [&](const Registration& registered) {
    return placement(registered_vertices(registered)).misfit();
  };
  const double trusting = misfit(by_all.registration);

  std::vector<RejectedAnchor> rejected = rejected_anchors(signs.suspects, reject);
  double undoubted = misfit(trial.registered);
  if (rejected.size() > 1 && rejected.size() <= few && undoubted > trusting) {
    rejected = rejected_anchors(rejected_alone(rejected, reject), reject);
    undoubted = misfit(trial.registered);
  }
  if (rejected.empty() || undoubted > trusting) return by_all;

  Registration best = trial.registered;
  if (rejected.size() == 1 || rejected.size() > few)
    return {std::move(best), without(by_all.estimated, rejected)};
  const ReinstateAnchor reinstate = [&](std::size_t anchor, const std::vector<std::size_t>& others) {
    trial.register_without(others);
    const std::vector<std::size_t> suspect_pairs =
        signs.test.suspects(registered_vertices(trial.registered), signs.audit);
    const double with_anchor = misfit(trial.registered);
    if (std::binary_search(suspect_pairs.begin(), suspect_pairs.end(), anchor) || with_anchor > undoubted)
      return false;
    best = trial.registered;
    undoubted = with_anchor;
    return true;
  };
  rejected = not_reinstated(rejected, reinstate);
  return {std::move(best), without(by_all.estimated, rejected)};
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
Registration register_by_counterparts(const RegistrationTask& task, const RegistrationByAnchors& by_anchors,
                                      const Progress& progress) {
  constexpr double accuracy = 0.01;        // of the target's diagonal (tests/accuracy/tuning.md)
  constexpr double far_off = 3;            // standard deviations
  constexpr double clearly_better = 0.99;  // ratio of the misfits (tests/accuracy/tuning.md)
  const Stopwatch watch;
  const auto& [registration, estimated] = by_anchors;
  const GeodesicCounterparts counterparts = remote_counterparts(task, estimated.anchors, progress);
  if (counterparts.sources.cols() == 0) return registration;
  const double sigma = accuracy * diagonal(task.problem.target.vertices);
  const Points places = registered_with_source(registration, task.problem.source, counterparts.sources);
  const auto displaced = ((places - counterparts.targets).colwise().norm().array() > far_off * sigma).count();
  if (displaced < 2) return registration;  // one alone may be mistaken
  const PlacementScore placement(task.problem.source, task.problem.target);
  const PlacementFigures figures = placement(registered_vertices(registration));
  if (!is_suspect(figures)) return registration;

  Registration trial = register_by_pairs(task, estimated, pairs_of(counterparts, sigma), progress);
  const bool taken = placement(registered_vertices(trial)).misfit() < clearly_better * figures.misfit();
  Registration result = taken ? std::move(trial) : registration;
  result.summary.counterparts = {static_cast<std::size_t>(counterparts.sources.cols()),
                                 static_cast<std::size_t>(displaced), taken, watch.seconds()};
  return result;
}

/// Without those of curves.
std::vector<double> given_sigmas(const EstimatedAnchors& estimated, const Anchors& given) {
  return {estimated.sigmas.begin(),
          estimated.sigmas.begin() + static_cast<std::ptrdiff_t>(given.pairs.size())};
}

/// What the surface fitting did not meet is not exact for those after it.
EstimatedAnchors with_given_way(EstimatedAnchors estimated, const Anchors& given,
                                const std::vector<AnchorGivenWay>& given_way) {
  for (const AnchorGivenWay& anchor : given_way) {
    if (anchor.index >= estimated.kept.size()) continue;  // a counterpart
    const std::size_t number = estimated.kept[anchor.index];
    estimated.anchors.pairs[anchor.index].sigma = anchor.sigma;
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
  const TriangleMesh& source = task.problem.source;
  const TriangleMesh& target = task.problem.target;
  const Anchors& given = task.problem.anchors;
  EstimatedAnchors estimated = estimate_anchor_sigmas(anchors, source, target);
  // The printed method takes all pairs.
  const bool doubts = task.options.method == SurfaceFitMethod::deformation_graph;
  if (doubts) let_contradicting_share(estimated, given.pairs.size(), task.options.max_stretch);
  Registration by_all = register_by_pairs(task, estimated, {}, progress);
  RegistrationByAnchors best{std::move(by_all), std::move(estimated)};
  AnchorAudit audit = audit_anchors(given);
  if (doubts) {
    const AnchorOutlierTest outlier_test(source, target, given, best.estimated);
    const std::vector<std::size_t> suspects =
        outlier_test.suspects(registered_vertices(best.registration), audit);
    if (!suspects.empty()) best = register_by_inliers(task, best, {outlier_test, audit, suspects}, progress);
    best.registration = register_by_counterparts(task, best, progress);
    audit = outlier_test.unexplained(std::move(audit), registered_vertices(best.registration));
  }
  Registration result = std::move(best.registration);
  CoarseSummary& coarse = *result.summary.coarse;
  coarse.contradicting = contradicting_anchors(given, given_sigmas(best.estimated, given));
  coarse.audit = std::move(audit);
  EstimatedAnchors used =
      with_given_way(std::move(best.estimated), given, result.summary.surface->anchors_given_way);
  result.summary.accuracy = std::move(used.accuracy);
  result.anchor_sigma = given_sigmas(used, given);
  result.anchors = std::move(used.anchors);
  return result;
}

}  // namespace bespoke
