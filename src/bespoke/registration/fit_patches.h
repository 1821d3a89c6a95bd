#pragma once

#include <vector>

#include "bespoke/anchors/patch_borders.h"
#include "bespoke/anchors/patch_faces.h"
#include "bespoke/registration/fit_summary.h"

namespace bespoke {

/// The patches of both models as a fit takes them; all empty where there are none.
struct FitPatches {
  FacePatches source;
  FacePatches target;
  std::vector<PatchBorder> borders;  ///< curves that the fit meets beside those given
  std::vector<PatchSummary> found;   ///< one per patch, without distances
};

/// Throws InvalidInput as face_patches and patch_borders; where there is neither a pair nor a curve, for a
/// patch says what belongs together, not where; and where most of the pairs that lie well inside a patch on
/// one model lie well outside on the other, so that the other side of its border was meant.
FitPatches fit_patches(const Anchors& anchors, const TriangleMesh& source, const TriangleMesh& target);

}  // namespace bespoke
