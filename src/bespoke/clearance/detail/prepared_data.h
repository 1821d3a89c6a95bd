#pragma once

#include "bespoke/clearance/detail/correction_graph.h"
#include "bespoke/clearance/detail/product_samples.h"
#include "bespoke/clearance/detail/smooth_correction.h"
#include "bespoke/clearance/prepared_product.h"

namespace bespoke {

struct PreparedProduct::Data {
  TriangleMesh mesh;
  CorrectionGraph graph;
  SmoothCorrection energy;
  ProductSamples samples;  ///< that are constrained
  ProductSamples checks;   ///< that are looked at afterwards
};

}  // namespace bespoke
