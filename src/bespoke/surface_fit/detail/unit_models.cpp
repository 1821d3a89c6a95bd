#include "bespoke/surface_fit/detail/unit_models.h"

namespace bespoke {

Similarity similarity_of_warp(const SurfaceFitInput& input) {
  return align_similarly(input.source.vertices, input.warped_vertices,
                         Eigen::VectorXd::Ones(input.source.vertices.cols()));
}

UnitModels::UnitModels(const SurfaceFitInput& input)
    : given_(input),
      source_size_(diagonal(input.source.vertices)),
      target_size_(source_size_ * similarity_of_warp(input).scale),
      source_{input.source.vertices / source_size_, input.source.faces},
      target_{input.target.vertices / target_size_, input.target.faces},
      warped_(input.warped_vertices / target_size_),
      anchor_sources_(input.anchor_sources / source_size_),
      anchor_targets_(input.anchor_targets / target_size_) {}

SurfaceFitInput UnitModels::input() const {
  return {source_,
          warped_,
          target_,
          anchor_sources_,
          anchor_targets_,
          given_.anchor_weights,
          given_.anchor_sigmas / target_size_,
          given_.source_patches,
          given_.target_patches,
          given_.anchor_tested};
}

SurfaceFit UnitModels::restored(SurfaceFit fit) const {
  fit.vertices *= target_size_;
  for (Statistics* each : {&fit.summary.before, &fit.summary.after})
    for (double* value : {&each->min, &each->median, &each->p95, &each->p99, &each->max})
      *value *= target_size_;
  for (AnchorGivenWay& anchor : fit.summary.anchors_given_way) anchor.sigma *= target_size_;
  return fit;
}

}  // namespace bespoke
