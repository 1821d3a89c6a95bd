#pragma once

#include <vector>

#include "bespoke/alignment/detail/soft_matches.h"
#include "bespoke/rigid/similarity_alignment.h"

namespace bespoke {

/// The patches of a source registered to those of a target.
struct PatchDeformation {
  Points points;                      ///< 3×n, target frame, mesh units
  Points normals;                     ///< 3×n, unit
  std::vector<Matrix3> similarities;  ///< n: scale × rotation around each patch
  SoftMatches matches;                ///< found last
  double residual = 0;  ///< root mean square distance from the matches, fraction of the target's radius
  double bending = 0;   ///< root mean square deviation of the links from the similarity around them, fraction

  /// Π of what no shape difference should need, divided by the share that was matched: the logarithm of a
  /// likelihood whose variances are unknown. No unit; lower is better.
  double misfit() const;
};

/// Deforms the source's patches, from `start` on: soft matches at a length that falls from a fifth of the
/// target's radius to half a patch, against stiffness × length² × (deviation of every link within two
/// patches from the similarity around its patch), so that the shape counts less as matches become certain.
/// Throws SolverError.
PatchDeformation deform_patches(const SurfacePatches& source, const SurfacePatches& target,
                                const Similarity& start);

/// Root mean square deviation of the links within two patches from the similarity around their patch, as in
/// PatchDeformation::bending. `patches`: of `mesh`, each with vertices in faces; `placed`: 3×n, where the
/// vertices went.
double distortion(const TriangleMesh& mesh, SurfacePatches patches, const Points& placed);

/// 3×(vertices of `mesh`), mesh units of the target: every vertex follows its patch and that patch's
/// neighbours, the nearer the more; vertices in no face follow `elsewhere`. `patches`: of `mesh`.
Points deformed_vertices(const TriangleMesh& mesh, const SurfacePatches& patches,
                         const PatchDeformation& deformation, const Similarity& elsewhere);

}  // namespace bespoke
