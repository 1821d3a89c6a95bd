#include "bespoke/pipeline/detail/register_source.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/alignment/geodesic_counterparts.h"
#include "bespoke/alignment/placement.h"
#include "bespoke/anchors/anchor_curves.h"
#include "bespoke/anchors/stretching_anchors.h"
#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/pipeline/detail/anchor_outliers.h"
#include "bespoke/pipeline/detail/anchor_start.h"
#include "bespoke/pipeline/detail/matched_parts.h"
#include "bespoke/pipeline/detail/part_pairs.h"
#include "bespoke/pipeline/detail/rejected_anchors.h"
#include "bespoke/pipeline/fit_patches.h"
#include "bespoke/quality/uncovered_area.h"
#include "bespoke/rbf/global_rbf.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

/// Weighted pairs of points as matrices: 3×k, 3×k and k.
struct Pairs {
  Points sources;
  Points targets;
  Eigen::VectorXd weights;
  Eigen::VectorXd sigmas;
};

Pairs pairs_of(const Anchors& anchors) {
  return {source_points(anchors), target_points(anchors), spline_weights(anchors), sigmas(anchors)};
}

/// Exact pairs at the corners of a box around the source, a tenth larger, which an affine map moves.
void add_corners(Pairs& pairs, const TriangleMesh& source, const AffineMap& map) {
  constexpr double larger = 1.1, thickest_sheet = 0.1;  // the latter of the diagonal
  const Box box = bounding_box(source.vertices);
  const Vector3 sizes = larger * box.sizes().cwiseMax(thickest_sheet * box.diagonal().norm());
  const Eigen::Index count = pairs.sources.cols();
  Points corners(3, 8);
  for (int k = 0; k < 8; ++k)
    corners.col(k) =
        box.center() + sizes.cwiseProduct(Vector3(k & 4 ? 1 : -1, k & 2 ? 1 : -1, k & 1 ? 1 : -1)) / 2;
  pairs.sources.conservativeResize(3, count + 8);
  pairs.sources.rightCols(8) = corners;
  pairs.targets.conservativeResize(3, count + 8);
  pairs.targets.rightCols(8) = map * corners;
  pairs.weights.conservativeResize(count + 8);
  pairs.weights.tail(8).setConstant(std::numeric_limits<double>::infinity());
}

/// The coarse warp of the source's vertices (IV.B). pairs: the anchors, source frame, the first `count` of
/// which were given. Where their spread does not determine the affine part, corners of a box tell it, as
/// the regularised alignment takes them.
Points warp_coarsely(const TriangleMesh& source, Pairs pairs, Eigen::Index count, const AnchorStart& start,
                     CoarseSummary& summary) {
  const Stopwatch watch;
  const RegularisedAlignment& alignment = start.alignment;
  summary.regularised = pairs.sources.cols() > 3 && !start.determines_affine_map;
  summary.turned_by_surfaces = start.turned_by_surfaces;
  summary.anchor_widths = alignment.widths;
  if (summary.regularised) {
    const Matrix3 back = start.target_from_source.rotation.transpose();
    const AffineMap& map = alignment.affine.linear.determinant() > 0
                               ? alignment.affine
                               : AffineMap{alignment.similarity.scale * alignment.similarity.rotation,
                                           alignment.similarity.translation};
    add_corners(pairs, source,
                {back * map.linear, back * (map.offset - start.target_from_source.translation)});
  }
  const GlobalRbf coarse(pairs.sources, pairs.targets, pairs.weights);
  Points warped = coarse(source.vertices);
  summary.residuals =
      summarize(distances(coarse(pairs.sources.leftCols(count)), pairs.targets.leftCols(count)));
  summary.seconds = watch.seconds();
  return warped;
}

/// What is registered to what, and as which parts.
struct RegistrationInput {
  const TriangleMesh& source;
  const TriangleMesh& target;
  const FitPatches& patches;
  const Anchors& given;
  const FitOptions& options;
  std::vector<AnchorPair> of_parts = {};  ///< that lead parts without anchors
};

/// Γ by anchors, those of curves included, and H'_a by these and by what is known of places far from them.
void register_by_pairs(FittedMapping& result, const RegistrationInput& input,
                       const EstimatedAnchors& estimated, const Progress& progress,
                       const std::vector<AnchorPair>& counterparts = {}) {
  FitSummary& summary = result.summary;
  const auto& [source, target, patches, given, options, of_parts] = input;
  const auto count = static_cast<Eigen::Index>(estimated.anchors.pairs.size());
  Anchors all = estimated.anchors;
  all.pairs.insert(all.pairs.end(), of_parts.begin(), of_parts.end());
  all.pairs.insert(all.pairs.end(), counterparts.begin(), counterparts.end());
  Pairs pairs = pairs_of(all);

  // IV.A: Γ. From here on everything is in the source frame.
  const Stopwatch rigid_watch;
  progress.step("rigid", 0, 0);
  if (const std::string off = off_target(estimated.accuracy, target); !off.empty()) throw InvalidInput(off);
  const AnchorStart start = start_by_anchors(estimated.anchors, pairs.weights.head(count), source, target);
  result.target_from_source = start.target_from_source;
  summary.rigid =
      rigid_summary(result.target_from_source, pairs.sources.leftCols(count), pairs.targets.leftCols(count));
  const RigidTransform source_from_target = inverse(result.target_from_source);
  pairs.targets = (source_from_target * pairs.targets).eval();
  const TriangleMesh target_in_source{source_from_target * target.vertices, target.faces};
  summary.rigid.seconds = rigid_watch.seconds();

  // IV.B: Ẽ.
  progress.step("coarse", 0, 0);
  const Points warped = warp_coarsely(source, pairs, count, start, summary.coarse.emplace());

  // IV.C: H'_a.
  SurfaceFit fit = fit_surface({source, warped, target_in_source, pairs.sources, pairs.targets, pairs.weights,
                                pairs.sigmas, patches.source, patches.target},
                               options.surface_fit, progress);
  result.fitted_vertices = std::move(fit.vertices);
  result.confidence = std::move(fit.confidence);
  summary.surface = std::move(fit.summary);
  summary.surface_method = options.surface_fit.method;
}

/// The source's registered vertices, 3×n, target frame.
Points registered_vertices(const FittedMapping& registered) {
  return registered.target_from_source * registered.fitted_vertices;
}

/// The images of points on or near the source under the registration, target frame.
Points registered_with_source(const FittedMapping& registered, const TriangleMesh& source, const Points& x) {
  const ClosestPointTree tree(source);
  const Points vertices = registered_vertices(registered);
  Points places(3, x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    places.col(i) = carried(*tree.closest(x.col(i)), source.faces, vertices);
  return places;
}

/// The source registered by its estimated pairs without some of them.
struct RegistrationTrial {
  const RegistrationInput& input;
  const EstimatedAnchors& estimated;
  const AnchorOutlierTest& outlier_test;
  const Progress& progress;
  FittedMapping registered;  // the last

  /// Those of the pairs left out that the surfaces then displace.
  std::vector<RejectedAnchor> register_without(const std::vector<std::size_t>& left_out) {
    std::vector<RejectedAnchor> all;
    for (const std::size_t index : left_out) all.push_back({index, 0});
    register_by_pairs(registered, input, without(estimated, all), progress);
    return outlier_test.displaced_pairs(registered_vertices(registered), left_out);
  }
};

/// Registers the source without the pairs that the surfaces then displace, and keeps that if it explains the
/// target no worse than `result`. Where it explains it worse, right pairs may have been rejected beside wrong
/// ones: then each of a few is tested alone. Of a few rejected pairs those are reinstated that are no
/// suspects, and with which the target is explained no worse, without the others. Returns the pairs to be
/// used.
EstimatedAnchors register_by_inliers(FittedMapping& result, const RegistrationInput& input,
                                     const EstimatedAnchors& estimated, const AnchorOutlierTest& outlier_test,
                                     const AnchorAudit& audit, const std::vector<std::size_t>& suspects,
                                     const Progress& progress) {
  constexpr std::size_t few = 6;  // each is a surface fitting
  RegistrationTrial trial{input, estimated, outlier_test, progress, result};
  const RejectAnchors reject = [&](const auto& left_out) { return trial.register_without(left_out); };
  const PlacementScore placement(input.source, input.target);
  const auto misfit = [&](const FittedMapping& registered) {
    return placement(registered_vertices(registered)).misfit();
  };
  const double trusting = misfit(result);

  std::vector<RejectedAnchor> rejected = rejected_anchors(suspects, reject);
  double undoubted = misfit(trial.registered);
  if (rejected.size() > 1 && rejected.size() <= few && undoubted > trusting) {
    rejected = rejected_anchors(rejected_alone(rejected, reject), reject);
    undoubted = misfit(trial.registered);
  }
  if (rejected.empty() || undoubted > trusting) return estimated;

  result = trial.registered;
  if (rejected.size() == 1 || rejected.size() > few) return without(estimated, rejected);
  const ReinstateAnchor reinstate = [&](std::size_t anchor, const std::vector<std::size_t>& others) {
    trial.register_without(others);
    const std::vector<std::size_t> suspect_pairs =
        outlier_test.suspects(registered_vertices(trial.registered), audit);
    const double with_anchor = misfit(trial.registered);
    if (std::binary_search(suspect_pairs.begin(), suspect_pairs.end(), anchor) || with_anchor > undoubted)
      return false;
    result = trial.registered;
    undoubted = with_anchor;
    return true;
  };
  return without(estimated, not_reinstated(rejected, reinstate));
}

GeodesicCounterparts remote_counterparts(const RegistrationInput& input, const Anchors& anchors,
                                         const Progress& progress) {
  return geodesic_counterparts(without_excluded(input.source, input.patches.source).mesh,
                               without_excluded(input.target, input.patches.target).mesh,
                               source_points(anchors), target_points(anchors), {}, progress);
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
void register_by_counterparts(FittedMapping& result, const RegistrationInput& input,
                              const EstimatedAnchors& estimated, const Progress& progress) {
  constexpr double accuracy = 0.01;        // of the target's diagonal (tests/accuracy/tuning.md)
  constexpr double far_off = 3;            // standard deviations
  constexpr double clearly_better = 0.99;  // ratio of the misfits (tests/accuracy/tuning.md)
  const Stopwatch watch;
  const GeodesicCounterparts counterparts = remote_counterparts(input, estimated.anchors, progress);
  if (counterparts.sources.cols() == 0) return;
  const double sigma = accuracy * diagonal(input.target.vertices);
  const Points places = registered_with_source(result, input.source, counterparts.sources);
  const auto displaced = ((places - counterparts.targets).colwise().norm().array() > far_off * sigma).count();
  if (displaced < 2) return;  // one alone may be mistaken
  const PlacementScore placement(input.source, input.target);
  const PlacementFigures by_anchors = placement(registered_vertices(result));
  if (!is_suspect(by_anchors)) return;

  FittedMapping trial = result;
  register_by_pairs(trial, input, estimated, progress, pairs_of(counterparts, sigma));
  const bool taken = placement(registered_vertices(trial)).misfit() < clearly_better * by_anchors.misfit();
  if (taken) result = std::move(trial);
  result.summary.counterparts = {static_cast<std::size_t>(counterparts.sources.cols()),
                                 static_cast<std::size_t>(displaced), taken, watch.seconds()};
}

/// Without those of curves.
std::vector<double> given_sigmas(const EstimatedAnchors& estimated, const Anchors& given) {
  return {estimated.sigmas.begin(),
          estimated.sigmas.begin() + static_cast<std::ptrdiff_t>(given.pairs.size())};
}

/// What the surface fitting did not meet is not exact for those after it.
void let_give_way(EstimatedAnchors& estimated, const Anchors& given,
                  const std::vector<AnchorGivenWay>& given_way) {
  for (const AnchorGivenWay& anchor : given_way) {
    if (anchor.index >= estimated.kept.size()) continue;  // a counterpart
    const std::size_t number = estimated.kept[anchor.index];
    estimated.anchors.pairs[anchor.index].sigma = anchor.sigma;
    estimated.sigmas[number] = anchor.sigma;
    if (number < given.pairs.size()) estimated.accuracy.given_way.push_back({number, anchor.sigma});
  }
}

/// Γ and H'_a by anchors, those of curves included; only given ones are tested. Returns the
/// anchors as the fit took them.
Anchors register_by_anchors(FittedMapping& result, const RegistrationInput& input, const Anchors& anchors,
                            const Progress& progress) {
  EstimatedAnchors estimated = estimate_anchor_sigmas(anchors, input.source, input.target);
  // The printed method takes all pairs.
  const bool doubts = input.options.surface_fit.method == SurfaceFitMethod::deformation_graph;
  if (doubts)
    let_contradicting_share(estimated, input.given.pairs.size(), input.options.surface_fit.max_stretch);
  register_by_pairs(result, input, estimated, progress);
  AnchorAudit audit = audit_anchors(input.given);
  if (doubts) {
    const AnchorOutlierTest outlier_test(input.source, input.target, input.given, estimated);
    const std::vector<std::size_t> suspects = outlier_test.suspects(registered_vertices(result), audit);
    if (!suspects.empty())
      estimated = register_by_inliers(result, input, estimated, outlier_test, audit, suspects, progress);
    register_by_counterparts(result, input, estimated, progress);
    audit = outlier_test.unexplained(std::move(audit), registered_vertices(result));
  }
  result.summary.coarse->contradicting =
      contradicting_anchors(input.given, given_sigmas(estimated, input.given));
  let_give_way(estimated, input.given, result.summary.surface->anchors_given_way);
  result.summary.coarse->audit = std::move(audit);
  result.summary.accuracy = std::move(estimated.accuracy);
  result.anchor_sigma = given_sigmas(estimated, input.given);
  return estimated.anchors;
}

/// Where exact pairs hold the source.
Points held_places(const Anchors& anchors) {
  Points held(3, 0);
  for (const AnchorPair& pair : anchors.pairs) {
    if (!is_exact(pair)) continue;
    held.conservativeResize(3, held.cols() + 1);
    held.rightCols(1) = pair.b;
  }
  return held;
}

/// The same with curves, in two fits: the first may move along them, and across within what matching by
/// length leaves open; the second meets them where the first came to lie, as far as that needs no fold.
Anchors register_by_curves(FittedMapping& result, const RegistrationInput& input, const Anchors& anchors,
                           const Progress& progress) {
  constexpr double spacing = 0.01, sliding = 0.02;  // of the source's diagonal
  constexpr double reach = 3;                       // standard deviations of the sliding
  const double size = diagonal(input.source.vertices);
  CurvePairs curves(anchors, spacing * size);
  FittedMapping first;
  const Anchors estimated = register_by_anchors(first, input, curves.pairs(sliding * size), progress);
  const Points registered = registered_with_source(first, input.source, curves.sources());
  curves.slide(registered, reach * sliding * size);
  curves.give_way(registered, held_places(estimated));
  return register_by_anchors(result, input, curves.pairs(0), progress);
}

/// Γ and H'_a by the two surfaces alone.
void register_by_surfaces(FittedMapping& result, const TriangleMesh& source, const TriangleMesh& target,
                          const FitOptions& options, const Progress& progress) {
  UnanchoredFit fit = fit_unanchored(source, target, options.surface_fit, progress);
  FitSummary& summary = result.summary;
  result.target_from_source = fit.target_from_source;
  result.fitted_vertices = std::move(fit.surface.vertices);
  result.confidence = std::move(fit.surface.confidence);
  summary.rigid.by_vertices = true;
  summary.rigid.rotation = rotation_angle(fit.target_from_source);
  summary.rigid.residuals = summarize(distances(source.vertices, fit.start));
  summary.surface = std::move(fit.surface.summary);
  summary.surface_method = options.surface_fit.method;
  summary.unanchored = std::move(fit.summary);
}

/// Patches of the parts that correspond, where anchors place the source and nobody gave patches. Returns
/// pairs of those without anchors.
std::vector<AnchorPair> add_matched_parts(FitPatches& patches, const TriangleMesh& source,
                                          const TriangleMesh& target, const Anchors& anchors,
                                          const FitOptions& options, FitSummary& summary) {
  constexpr std::size_t min_pairs = 4;
  if (options.surface_fit.method != SurfaceFitMethod::deformation_graph || !patches.source.is_empty() ||
      anchors.pairs.size() < min_pairs || part_count(source) < 2 || part_count(target) < 2)
    return {};
  const RegularisedAlignment alignment =
      align_regularised(source_points(anchors), target_points(anchors),
                        Eigen::VectorXd::Ones(static_cast<Eigen::Index>(anchors.pairs.size())));
  const Points placed = alignment.affine * source.vertices;
  MatchedParts parts = match_parts(source, placed, target);
  summary.matched_parts = to_string(parts);
  std::vector<AnchorPair> pairs = part_pairs({source, placed, target, parts}, source_points(anchors));
  patches.source = std::move(parts.source);
  patches.target = std::move(parts.target);
  return pairs;
}

/// Γ and H'_a, however they are found. Returns the anchors as the fit took them.
Anchors register_models(FittedMapping& result, const RegistrationInput& input, const Progress& progress) {
  Anchors lines = input.given;
  for (const PatchBorder& border : input.patches.borders) lines.curves.push_back(border.curve);
  if (!lines.curves.empty()) return register_by_curves(result, input, lines, progress);
  if (!input.given.pairs.empty()) return register_by_anchors(result, input, input.given, progress);
  register_by_surfaces(result, input.source, input.target, input.options, progress);
  return {};
}

}  // namespace

Anchors register_source(FittedMapping& result, const TriangleMesh& source, const TriangleMesh& target,
                        const Anchors& anchors, const FitOptions& options, const Progress& progress) {
  FitPatches patches = fit_patches(anchors, source, target);
  result.summary.patches = patches.found;
  const std::vector<AnchorPair> of_parts =
      add_matched_parts(patches, source, target, anchors, options, result.summary);
  Anchors estimated =
      register_models(result, {source, target, patches, anchors, options, of_parts}, progress);
  constexpr double reach = 0.01;  // of the target's diagonal
  result.summary.uncovered =
      uncovered_area(without_excluded(target, patches.target).mesh,
                     {registered_vertices(result), source.faces}, reach * diagonal(target.vertices));
  return estimated;
}

}  // namespace bespoke
