#pragma once

#include <optional>
#include <string>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/progress.h"
#include "bespoke/rigid/similarity_alignment.h"

namespace bespoke {

/// What keeps an alignment from being trusted.
enum class AlignmentVerdict {
  certain,
  poor,       ///< no alignment fits: other things, other poses, or one model is inside out
  ambiguous,  ///< another alignment, in another place, fits about as well
  mirrored,   ///< a mirror image of the source fits better, or about as well although neither model is
              ///< symmetric
};

/// How a source was aligned with a target, and with which confidence.
struct AlignmentSummary {
  AlignmentVerdict verdict = AlignmentVerdict::poor;
  /// √(residual × bending) / share matched after a coarse deformation, no unit; lower is better, and above
  /// 0.06 an alignment is usually wrong (tests/accuracy/tuning.md).
  double misfit = 0;
  std::optional<double> next_misfit;  ///< of the best alignment elsewhere; none when all lead to one place
  std::optional<double>
      mirror_misfit;     ///< of the best alignment of the source's mirror image, where it tells
  double scale = 1;      ///< of the similarity
  double residual = 0;   ///< root mean square distance, fraction of the target's radius
  double bending = 0;    ///< root mean square deviation from local similarities, fraction
  double matched = 0;    ///< share of the two surfaces that found counterparts
  double asymmetry = 0;  ///< of the more mirror-symmetric model, fraction of its radius
  /// The source's open boundaries found the target's: both are cut at the same place.
  bool same_boundaries = false;
  double seconds = 0;

  /// 1 − misfit / next_misfit, and no more than the same of mirror_misfit; in [0, 1].
  double confidence() const;
};

/// One line.
std::string to_string(const AlignmentSummary& summary);

/// Where the source lies on the target, found from the two surfaces alone.
struct Alignment {
  Similarity target_from_source;  ///< least squares over all patches of the source
  Points deformed;  ///< 3×n: the source's vertices coarsely registered to the target, mesh units
  Similarity source_from_target;  ///< the inverse
  Points target_deformed;  ///< 3×m: the target's vertices coarsely registered to the source, where certain;
                           ///< else 3×0
  AlignmentSummary summary;
};

/// Two models of one kind in similar pose, in any position and unit. Similarities from 72 rotations, of the
/// source and of its mirror image, are refined by soft matches on normals, curvatures and boundaries; the
/// best few are deformed coarsely, and judged by distance, distortion and share matched. A model that is
/// symmetric leaves nothing to tell its mirror image by, so the mirror image counts only when neither is.
/// Throws InvalidInput, SolverError, Interrupted.
Alignment align_models(const TriangleMesh& source, const TriangleMesh& target, const Progress& progress = {});

/// Throws SolverError, saying what was ambiguous and what to do, unless the verdict is `certain`.
void require_certain(const AlignmentSummary& summary);

}  // namespace bespoke
