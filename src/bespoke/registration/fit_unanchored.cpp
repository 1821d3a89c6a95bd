#include "bespoke/registration/fit_unanchored.h"

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/spread_points.h"
#include "bespoke/registration/detail/two_way_points.h"
#include "bespoke/rigid/rigid_alignment.h"
#include "bespoke/statistics.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

/// Of the target's area that the fitted source must reach: less where a limb was left behind
/// (tests/accuracy/tuning.md).
constexpr double min_covered = 0.99;

/// Vertices at which the two directions lead: each some tenth of the diagonal from the next.
constexpr std::size_t leading_vertices = 100;
/// Of the diagonal: no anchor is taken for more accurate, as for those that people pick.
constexpr double min_lead_sigma = 1e-3;

struct Candidate {
  SurfaceFit surface;
  PlacementFigures placement;
};

/// Anchors of limited accuracy.
struct Leads {
  std::vector<int> vertices;  // of the source
  Points targets;             // 3×k, source frame
  Eigen::VectorXd sigmas;     // k, mesh units
};

struct Scene {
  const TriangleMesh& source;
  const TriangleMesh& target;  // in the source frame
  SurfaceFitOptions options;
  const TriangleMesh& target_in_place;
  const PlacementScore& score;  // in the source frame
};

/// A surface to be fitted onto another, and where it starts.
struct Start {
  const Points& vertices;  // 3×n
  const Faces& faces;
  const TriangleMesh& fixed;
};

SurfaceFit fit_surface_from(const Start& from, const Leads& leads, const SurfaceFitOptions& options,
                            const Progress& progress) {
  const auto& [start, faces, fixed] = from;
  const TriangleMesh started{start, faces};
  const Points sources = start(Eigen::all, leads.vertices);
  // Where σ is not requested, each counts like one per cent of the surface.
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(sources.cols());
  return fit_surface({started, start, fixed, sources, leads.targets, weights, leads.sigmas}, options,
                     progress);
}

Candidate fit_from(const Points& start, const Scene& scene, const Leads& leads, const Progress& progress) {
  Candidate candidate;
  candidate.surface =
      fit_surface_from({start, scene.source.faces, scene.target}, leads, scene.options, progress);
  candidate.placement = scene.score(candidate.surface.vertices);
  return candidate;
}

/// The middle between where a fit of the source takes some vertices and where a fit of the target comes from;
/// half of the distance between the two is the accuracy. `back`: the target's vertices on the source.
Leads leads_of(const Scene& scene, const Points& forward, const Points& back) {
  Leads leads;
  leads.vertices = spread_vertices(scene.source, leading_vertices);
  TwoWayPoints points = two_way_points(scene.source, forward, scene.target, back, leads.vertices);
  leads.targets = std::move(points.middles);
  leads.sigmas = (points.apart / 2).cwiseMax(min_lead_sigma * diagonal(scene.source.vertices));
  return leads;
}

/// The best fit of all starts, and how it was found (UnanchoredSummary).
struct BestFit {
  Candidate best;
  bool from_deformed = false, of_both_directions = false;
  double disagreement = 0;
};

bool is_better(const Candidate& other, const Candidate& than) {
  return other.placement.misfit() < than.placement.misfit();
}

/// similar, deformed: the source's vertices, 3×n, source frame.
struct Starts {
  const Points& similar;
  const Points& deformed;
  const Alignment& alignment;
};

BestFit best_fit(const Starts& starts, const Scene& scene, const Progress& progress) {
  BestFit result{fit_from(starts.similar, scene, {}, progress)};
  if (result.best.surface.summary.similarity_suffices) return result;
  Candidate deformed = fit_from(starts.deformed, scene, {}, progress);
  result.from_deformed = is_better(deformed, result.best);
  if (result.from_deformed) result.best = std::move(deformed);

  const Alignment& alignment = starts.alignment;
  const Points back_start = result.from_deformed
                                ? alignment.target_deformed
                                : Points(alignment.source_from_target * scene.target_in_place.vertices);
  const SurfaceFit back =
      fit_surface_from({back_start, scene.target.faces, scene.source}, {}, scene.options, progress);
  const Leads leads = leads_of(scene, result.best.surface.vertices, back.vertices);
  const std::vector<double> sigmas(leads.sigmas.begin(), leads.sigmas.end());
  result.disagreement = 2 * summarize(sigmas).median / diagonal(scene.target.vertices);
  Candidate led = fit_from(result.from_deformed ? starts.deformed : starts.similar, scene, leads, progress);
  result.of_both_directions = is_better(led, result.best);
  if (result.of_both_directions) result.best = std::move(led);
  return result;
}

void require_covered(const UnanchoredSummary& summary) {
  if (summary.placement.covered >= min_covered) return;
  throw SolverError(
      "without anchors: the source does not reach all of the target, so parts of it went elsewhere; give at "
      "least 4 anchors (--anchors): " +
      to_string(summary));
}

}  // namespace

std::string to_string(const UnanchoredSummary& summary) {
  char text[300];
  std::snprintf(text, sizeof text,
                "; fitted from the %s%s: %.2f %% of the target reached, distance %.3f %%, distortion %.1f %%",
                summary.from_deformed ? "coarse deformation" : "similarity",
                summary.of_both_directions ? ", in both directions" : "", 100 * summary.placement.covered,
                100 * summary.placement.distance, 100 * summary.placement.distortion);
  return to_string(summary.alignment) + text;
}

UnanchoredFit fit_unanchored(const TriangleMesh& source, const TriangleMesh& target,
                             const SurfaceFitOptions& options, const Progress& progress) {
  const Stopwatch watch;
  const Alignment alignment = align_models(source, target, progress);
  require_certain(alignment.summary);

  UnanchoredFit fit;
  fit.target_from_source =
      align_rigidly(source.vertices, alignment.deformed, Eigen::VectorXd::Ones(source.vertices.cols()));
  const RigidTransform source_from_target = inverse(fit.target_from_source);
  const TriangleMesh target_in_source{source_from_target * target.vertices, target.faces};
  fit.start = source_from_target * alignment.deformed;
  SurfaceFitOptions rules = options;
  rules.tell_rigidity = false;
  if (rules.boundaries == BoundaryRule::automatic)
    rules.boundaries = alignment.summary.same_boundaries ? BoundaryRule::matched : BoundaryRule::free;

  const Points similar = source_from_target * (alignment.target_from_source * source.vertices);
  const PlacementScore score(source, target_in_source);
  BestFit found =
      best_fit({similar, fit.start, alignment}, {source, target_in_source, rules, target, score}, progress);
  fit.surface = std::move(found.best.surface);
  fit.summary = {alignment.summary,        found.best.placement, found.from_deformed,
                 found.of_both_directions, found.disagreement,   0};
  fit.summary.seconds = watch.seconds() - fit.surface.summary.seconds;
  require_covered(fit.summary);
  return fit;
}

}  // namespace bespoke
