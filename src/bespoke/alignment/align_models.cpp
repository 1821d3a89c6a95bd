#include "bespoke/alignment/align_models.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>
#include <vector>

#include "bespoke/alignment/detail/mirror_symmetry.h"
#include "bespoke/alignment/detail/patch_deformation.h"
#include "bespoke/alignment/detail/similarity_search.h"
#include "bespoke/alignment/detail/surface_patches.h"
#include "bespoke/error.h"
#include "bespoke/mesh/cavities.h"
#include "bespoke/parallel.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

struct Settings {
  int coarse_patches = 160;          // for the search: a finger is a few patches
  int patches = 600;                 // for the deformation
  std::size_t finalists = 4;         // alignments deformed
  std::size_t mirror_finalists = 3;  // alignments of the mirror image deformed
  double same_place = 0.1;           // mean distance between deformed patches, of the target's radius
  double worst_misfit = 0.057;       // of a correct alignment (tests/accuracy/tuning.md)
  double min_confidence = 0.2;       // a right foot fits a left one almost as well: that stays below
  double symmetric = 0.02;           // asymmetry of a person who stands straight, of the radius
  double boundary_share = 0.9;       // of the boundary's patches that must find a boundary
};
constexpr Settings settings;

std::vector<PatchDeformation> deform_best(const SurfacePatches& source, const SurfacePatches& target,
                                          const std::vector<SimilarityCandidate>& candidates,
                                          std::size_t most) {
  std::vector<PatchDeformation> all(std::min(most, candidates.size()));
  parallel_for(all.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      all[k] = deform_patches(source, target, candidates[k].target_from_source);
  });
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.misfit() < b.misfit(); });
  return all;
}

/// Whether nine tenths of the source's boundary patches lie where the target's boundary is.
bool boundaries_meet(const SurfacePatches& source, const SurfacePatches& target, const Points& points) {
  double meeting = 0;
  for (Eigen::Index i = 0; i < source.size(); ++i) {
    if (source.on_boundary[i] == 0) continue;
    for (Eigen::Index j = 0; j < target.size(); ++j)
      if (target.on_boundary[j] > 0 && (points.col(i) - target.points.col(j)).norm() < target.spacing) {
        meeting += 1;
        break;
      }
  }
  return meeting > 0 && meeting >= settings.boundary_share * source.on_boundary.sum();
}

/// Whether a misfit is clearly below that of an alternative, if there is one.
bool clearly_below(double misfit, const std::optional<double>& other) {
  return !other || misfit <= (1 - settings.min_confidence) * *other;
}

AlignmentVerdict judge(const AlignmentSummary& summary) {
  if (!(summary.misfit <= settings.worst_misfit)) return AlignmentVerdict::poor;
  if (!clearly_below(summary.misfit, summary.mirror_misfit)) return AlignmentVerdict::mirrored;
  if (!clearly_below(summary.misfit, summary.next_misfit)) return AlignmentVerdict::ambiguous;
  return AlignmentVerdict::certain;
}

/// What the alignment found with the mirror image of the source, where that can tell.
std::optional<double> misfit_of_mirror_image(const SurfacePatches& coarse_source,
                                             const SurfacePatches& coarse_target,
                                             const SurfacePatches& fine_source,
                                             const SurfacePatches& fine_target) {
  const auto candidates = search_similarities(mirrored(coarse_source), coarse_target, covering_rotations());
  const auto mirrors = deform_best(mirrored(fine_source), fine_target, candidates, settings.mirror_finalists);
  if (mirrors.empty()) return std::nullopt;
  return mirrors.front().misfit();
}

Similarity inverse(const Similarity& b_from_a) {
  const Matrix3 rotation = b_from_a.rotation.transpose();
  return {1 / b_from_a.scale, rotation, -(rotation * b_from_a.translation) / b_from_a.scale};
}

/// Misfit of the best of them that lies elsewhere than the first.
std::optional<double> misfit_elsewhere(const std::vector<PatchDeformation>& deformed, double radius) {
  for (const PatchDeformation& other : deformed) {
    const double apart = (other.points - deformed.front().points).colwise().norm().mean();
    if (apart >= settings.same_place * radius) return other.misfit();
  }
  return std::nullopt;
}

}  // namespace

double AlignmentSummary::confidence() const {
  double ratio = 0;
  for (const std::optional<double>& other : {next_misfit, mirror_misfit})
    if (other) ratio = std::max(ratio, misfit / *other);
  return std::max(0.0, 1 - ratio);
}

std::string to_string(const AlignmentSummary& summary) {
  char text[300];
  std::snprintf(text, sizeof text,
                "confidence %.2f, scaled by %.4g, %.0f %% matched, residual %.2f %%, bending %.1f %%, "
                "misfit %.4f",
                summary.confidence(), summary.scale, 100 * summary.matched, 100 * summary.residual,
                100 * summary.bending, summary.misfit);
  std::string line = text;
  const auto add = [&](const char* what, const std::optional<double>& other) {
    if (!other) return;
    std::snprintf(text, sizeof text, ", %s %.4f", what, *other);
    line += text;
  };
  add("next", summary.next_misfit);
  add("mirror image", summary.mirror_misfit);
  std::snprintf(text, sizeof text, ", %.2f s", summary.seconds);
  return line + text;
}

Alignment align_models(const TriangleMesh& source, const TriangleMesh& target, const Progress& progress) {
  const Stopwatch watch;
  progress.step("alignment", 0, 0);
  require_valid(source, "model to align");
  require_valid(target, "model to align");
  const std::vector<char> source_in_cavity = cavities_of(source).contains;
  const std::vector<char> target_in_cavity = cavities_of(target).contains;
  const SurfacePatches coarse_source =
      make_surface_patches(source, settings.coarse_patches, source_in_cavity);
  const SurfacePatches coarse_target =
      make_surface_patches(target, settings.coarse_patches, target_in_cavity);
  const auto candidates = search_similarities(coarse_source, coarse_target, covering_rotations());
  progress.check();
  Alignment alignment;
  alignment.deformed = source.vertices;
  AlignmentSummary& summary = alignment.summary;
  summary.misfit = std::numeric_limits<double>::infinity();
  if (candidates.empty()) return alignment;

  const SurfacePatches fine_source = make_surface_patches(source, settings.patches, source_in_cavity);
  const SurfacePatches fine_target = make_surface_patches(target, settings.patches, target_in_cavity);
  const auto deformed = deform_best(fine_source, fine_target, candidates, settings.finalists);
  progress.check();
  const PatchDeformation& best = deformed.front();
  summary.misfit = best.misfit();
  summary.residual = best.residual;
  summary.bending = best.bending;
  summary.matched = best.matches.matched();
  summary.next_misfit = misfit_elsewhere(deformed, fine_target.radius);
  summary.asymmetry =
      std::min(mirror_asymmetry(source, coarse_source), mirror_asymmetry(target, coarse_target));
  progress.check();
  if (summary.asymmetry > settings.symmetric)
    summary.mirror_misfit = misfit_of_mirror_image(coarse_source, coarse_target, fine_source, fine_target);
  summary.same_boundaries = boundaries_meet(fine_source, fine_target, best.points);
  alignment.target_from_source = align_similarly(fine_source.points, best.points, fine_source.areas);
  summary.scale = alignment.target_from_source.scale;
  alignment.deformed = deformed_vertices(source, fine_source, best, alignment.target_from_source);
  summary.verdict = judge(summary);
  alignment.source_from_target = inverse(alignment.target_from_source);
  if (summary.verdict == AlignmentVerdict::certain) {
    const PatchDeformation back = deform_patches(fine_target, fine_source, alignment.source_from_target);
    alignment.target_deformed = deformed_vertices(target, fine_target, back, alignment.source_from_target);
  }
  summary.seconds = watch.seconds();
  return alignment;
}

void require_certain(const AlignmentSummary& summary) {
  const std::string advice = "; give at least 4 anchors (--anchors): " + to_string(summary);
  switch (summary.verdict) {
    case AlignmentVerdict::certain:
      return;
    case AlignmentVerdict::poor:
      throw SolverError(
          "without anchors: no alignment of the models fits; they are of different kinds or in different "
          "poses, or one is inside out" +
          advice);
    case AlignmentVerdict::ambiguous:
      throw SolverError("without anchors: two different alignments of the models fit about as well" + advice);
    case AlignmentVerdict::mirrored:
      throw SolverError(
          "without anchors: a mirror image of the source fits the target about as well as the source or "
          "better" +
          advice);
  }
}

}  // namespace bespoke
