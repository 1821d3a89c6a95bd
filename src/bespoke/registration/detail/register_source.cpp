#include "bespoke/registration/detail/register_source.h"

#include <utility>
#include <vector>

#include "bespoke/anchors/anchor_curves.h"
#include "bespoke/quality/uncovered_area.h"
#include "bespoke/registration/detail/matched_parts.h"
#include "bespoke/registration/detail/part_pairs.h"
#include "bespoke/registration/detail/register_by_anchors.h"
#include "bespoke/rigid/regularised_alignment.h"

namespace bespoke {
namespace {

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

/// By anchors and curves, in two fits: the first may move along them, and across within what matching by
/// length leaves open; the second meets them where the first came to lie, as far as that needs no fold.
Registration register_by_curves(const RegistrationTask& task, const Anchors& anchors,
                                const Progress& progress) {
  constexpr double spacing = 0.01, sliding = 0.02;  // of the source's diagonal
  constexpr double reach = 3;                       // standard deviations of the sliding
  const double size = diagonal(task.problem.source.vertices);
  CurvePairs curves(anchors, spacing * size);
  const Registration first = register_by_anchors(task, curves.pairs(sliding * size), progress);
  const Points registered = registered_with_source(first, task.problem.source, curves.sources());
  curves.slide(registered, reach * sliding * size);
  curves.give_way(registered, held_places(first.anchors));
  return register_by_anchors(task, curves.pairs(0), progress);
}

/// By the two surfaces alone.
Registration register_by_surfaces(const RegistrationTask& task, const Progress& progress) {
  const TriangleMesh& source = task.problem.source;
  UnanchoredFit fit = fit_unanchored(source, task.problem.target, task.options, progress);
  Registration registration;
  registration.target_from_source = fit.target_from_source;
  registration.fitted_vertices = std::move(fit.surface.vertices);
  registration.confidence = std::move(fit.surface.confidence);
  RegistrationSummary& summary = registration.summary;
  summary.rigid.by_vertices = true;
  summary.rigid.rotation = rotation_angle(fit.target_from_source);
  summary.rigid.residuals = summarize(distances(source.vertices, fit.start));
  summary.surface = std::move(fit.surface.summary);
  summary.surface_method = task.options.method;
  summary.unanchored = std::move(fit.summary);
  return registration;
}

/// Which parts of the models correspond, where anchors place the source and nobody gave patches.
struct PartTask {
  FitPatches patches;                ///< those given, or of the parts
  std::vector<AnchorPair> of_parts;  ///< pairs of those without anchors
  std::string matched;               ///< one line; mostly empty
};

PartTask task_of_parts(const Problem& problem, const SurfaceFitOptions& options) {
  constexpr std::size_t min_pairs = 4;
  const TriangleMesh& source = problem.source;
  const TriangleMesh& target = problem.target;
  const Anchors& anchors = problem.anchors;
  PartTask task{fit_patches(anchors, source, target), {}, {}};
  if (options.method != SurfaceFitMethod::deformation_graph || !task.patches.source.is_empty() ||
      anchors.pairs.size() < min_pairs || part_count(source) < 2 || part_count(target) < 2)
    return task;
  const RegularisedAlignment alignment =
      align_regularised(source_points(anchors), target_points(anchors),
                        Eigen::VectorXd::Ones(static_cast<Eigen::Index>(anchors.pairs.size())));
  const Points placed = alignment.affine * source.vertices;
  MatchedParts parts = match_parts(source, placed, target);
  task.matched = to_string(parts);
  task.of_parts = part_pairs({source, placed, target, parts}, source_points(anchors));
  task.patches.source = std::move(parts.source);
  task.patches.target = std::move(parts.target);
  return task;
}

}  // namespace

Registration register_source(const Problem& problem, const FitOptions& options, const Progress& progress) {
  constexpr double reach = 0.01;  // of the target's diagonal
  PartTask parts = task_of_parts(problem, options.surface_fit);
  const RegistrationTask task{problem, parts.patches, options.surface_fit, parts.of_parts};
  Anchors lines = problem.anchors;
  for (const PatchBorder& border : parts.patches.borders) lines.curves.push_back(border.curve);
  Registration registration = !lines.curves.empty()  ? register_by_curves(task, lines, progress)
                              : !lines.pairs.empty() ? register_by_anchors(task, problem.anchors, progress)
                                                     : register_by_surfaces(task, progress);
  RegistrationSummary& summary = registration.summary;
  summary.uncovered = uncovered_area(without_excluded(problem.target, parts.patches.target).mesh,
                                     {registered_vertices(registration), problem.source.faces},
                                     reach * diagonal(problem.target.vertices));
  summary.patches = std::move(parts.patches.found);
  summary.matched_parts = std::move(parts.matched);
  return registration;
}

}  // namespace bespoke
