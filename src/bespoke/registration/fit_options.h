#pragma once

#include <cstddef>
#include <optional>

#include "bespoke/elastic/elastic_method.h"
#include "bespoke/surface_fit/surface_fit_options.h"

namespace bespoke {

struct FitOptions {
  SurfaceFitOptions surface_fit;
  ElasticMethod elastic = ElasticMethod::finite_elements;
  double lambda = 0;                    ///< effective distance, > 0, mesh units
  GuidedMaps guides = GuidedMaps::all;  ///< of methods that take them (elastic_methods.h)
  double max_squeeze = 50;              ///< of finite elements, each step of a chain, > 1 (ElasticOptions)
  double fit_tolerance =
      0;  ///< the multiscale methods stop refining below it, ≥ 0, mesh units; csrbf interpolates
  std::size_t max_memory = std::size_t{8} << 30;  ///< bytes
  /// Parts of the fitted source that touch or pass through each other are held this far apart (contact.h),
  /// ≥ 0, mesh units; 0 leaves them.
  double contact_offset = 0;
  std::optional<int> steps;  ///< of the chain, > 0; by the largest turn and stretch of a part when empty
  /// Whether models may differ by more than eight times in size: else they are refused, as if in two units.
  bool any_size = false;
  /// Whether anchors may lie off their models as if in another unit (anchor_scale.h): else they are refused.
  bool any_anchors = false;
};

}  // namespace bespoke
