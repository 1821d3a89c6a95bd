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
  // Right alignments of seven pairs of people have misfits of 0.03 to 0.05, at most 0.68 of the next one's.
  double worst_misfit = 0.06;
  double least_confidence = 0.2;
  double least_chirality = 0.1;  // a right foot fits a left one 13 % worse than its own side
  double symmetric = 0.02;       // asymmetry of a person who stands straight, of the radius
  double boundary_share = 0.9;   // of the boundary's patches that must find a boundary
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

AlignmentVerdict judge(const Alignment& alignment) {
  if (!(alignment.misfit <= settings.worst_misfit)) return AlignmentVerdict::poor;
  if (alignment.mirror_misfit &&
      !(alignment.misfit <= (1 - settings.least_chirality) * *alignment.mirror_misfit))
    return AlignmentVerdict::mirrored;
  if (alignment.next_misfit &&
      !(alignment.misfit <= (1 - settings.least_confidence) * *alignment.next_misfit))
    return AlignmentVerdict::ambiguous;
  return AlignmentVerdict::certain;
}

void add_deformation(Alignment& alignment, const TriangleMesh& source, const TriangleMesh& target,
                     const SurfacePatches& patches, const PatchDeformation& best) {
  alignment.target_from_source = align_similarly(patches.points, best.points, patches.areas);
  alignment.deformed = deformed_vertices(source, patches, best, alignment.target_from_source);
  const Points departure = best.points - alignment.target_from_source * patches.points;
  alignment.departure =
      std::sqrt(departure.colwise().squaredNorm().dot(patches.areas)) / diagonal(target.vertices);
}

}  // namespace

double Alignment::confidence() const {
  double ratio = 0;
  for (const std::optional<double>& other : {next_misfit, mirror_misfit})
    if (other) ratio = std::max(ratio, misfit / *other);
  return std::max(0.0, 1 - ratio);
}

std::string to_string(const Alignment& alignment) {
  char text[300];
  std::snprintf(text, sizeof text,
                "scaled by %.4g, %.0f %% matched, residual %.2f %%, bending %.1f %%, misfit %.4f",
                alignment.target_from_source.scale, 100 * alignment.matched, 100 * alignment.residual,
                100 * alignment.bending, alignment.misfit);
  std::string line = text;
  const auto add = [&](const char* what, const std::optional<double>& other) {
    if (!other) return;
    std::snprintf(text, sizeof text, ", %s %.4f", what, *other);
    line += text;
  };
  add("next", alignment.next_misfit);
  add("mirror image", alignment.mirror_misfit);
  std::snprintf(text, sizeof text, ", confidence %.2f, %.2f s", alignment.confidence(), alignment.seconds);
  return line + text;
}

Alignment align_models(const TriangleMesh& source, const TriangleMesh& target, const Progress& progress) {
  const Stopwatch watch;
  progress.step("alignment", 0, 0);
  const SurfacePatches coarse_source = make_surface_patches(source, settings.coarse_patches);
  const SurfacePatches coarse_target = make_surface_patches(target, settings.coarse_patches);
  const std::vector<Matrix3> starts = covering_rotations();
  const auto candidates = search_similarities(coarse_source, coarse_target, starts);
  progress.check();
  Alignment alignment;
  alignment.deformed = source.vertices;
  alignment.misfit = std::numeric_limits<double>::infinity();
  if (candidates.empty()) return alignment;

  const SurfacePatches fine_source = make_surface_patches(source, settings.patches);
  const SurfacePatches fine_target = make_surface_patches(target, settings.patches);
  const auto deformed = deform_best(fine_source, fine_target, candidates, settings.finalists);
  const PatchDeformation& best = deformed.front();
  alignment.misfit = best.misfit();
  alignment.residual = best.residual;
  alignment.bending = best.bending;
  alignment.matched = best.matches.matched();
  for (const PatchDeformation& other : deformed) {
    const double apart = (other.points - best.points).colwise().norm().mean();
    if (apart < settings.same_place * fine_target.radius) continue;
    alignment.next_misfit = other.misfit();
    break;
  }
  progress.check();
  alignment.asymmetry =
      std::min(mirror_asymmetry(source, coarse_source), mirror_asymmetry(target, coarse_target));
  if (alignment.asymmetry > settings.symmetric) {
    const auto mirror_candidates = search_similarities(mirrored(coarse_source), coarse_target, starts);
    progress.check();
    const auto mirrors =
        deform_best(mirrored(fine_source), fine_target, mirror_candidates, settings.mirror_finalists);
    if (!mirrors.empty()) alignment.mirror_misfit = mirrors.front().misfit();
  }
  alignment.same_boundaries = boundaries_meet(fine_source, fine_target, best.points);
  add_deformation(alignment, source, target, fine_source, best);
  alignment.verdict = judge(alignment);
  alignment.seconds = watch.seconds();
  return alignment;
}

void require_certain(const Alignment& alignment) {
  const std::string advice = "; give at least 4 anchors (--anchors): " + to_string(alignment);
  switch (alignment.verdict) {
    case AlignmentVerdict::certain:
      return;
    case AlignmentVerdict::poor:
      throw SolverError(
          "no alignment of the models fits: they are of different kinds or in different poses, or one is "
          "inside out" +
          advice);
    case AlignmentVerdict::ambiguous:
      throw SolverError("two different alignments of the models fit about as well" + advice);
    case AlignmentVerdict::mirrored:
      throw SolverError("a mirror image of the source fits the target as well as the source or better" +
                        advice);
  }
}

}  // namespace bespoke
