#pragma once

#include <vector>

#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke::test {

/// What surface fitting takes; the source lies where it is and has no anchors unless told otherwise.
struct FittingScene {
  TriangleMesh source;
  TriangleMesh target;
  Points warped = source.vertices;
  Points anchor_sources = Points(3, 0);
  Points anchor_targets = Points(3, 0);
  Eigen::VectorXd anchor_weights = Eigen::VectorXd(0);
  Eigen::VectorXd anchor_sigmas = Eigen::VectorXd(0);
  FacePatches source_patches = {};
  FacePatches target_patches = {};
  std::vector<char> anchor_tested = {};

  SurfaceFit fit(const SurfaceFitOptions& options = {}) const {
    return fit_surface({source, warped, target, anchor_sources, anchor_targets, anchor_weights, anchor_sigmas,
                        source_patches, target_patches, anchor_tested},
                       options);
  }
};

}  // namespace bespoke::test
