#pragma once

#include <vector>

#include "bespoke/registration/fit_patches.h"
#include "bespoke/registration/registration.h"

namespace bespoke {

/// What is registered to what, and as which parts. Refers to what it was made of.
struct RegistrationTask {
  const Problem& problem;  ///< with models that are joined at their seams (seams.h)
  const FitPatches& patches;
  const SurfaceFitOptions& options;
  std::vector<AnchorPair> of_parts = {};  ///< that lead parts without anchors
};

/// Γ and H'_a by `anchors`: those of the problem, of which suspects are tested, and perhaps points of curves
/// behind. Throws as register_models.
Registration register_by_anchors(const RegistrationTask& task, const Anchors& anchors,
                                 const Progress& progress);

/// The images of points on or near the source under the registration, target frame.
Points registered_with_source(const Registration& registration, const TriangleMesh& source, const Points& x);

}  // namespace bespoke
