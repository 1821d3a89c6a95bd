#pragma once

#include <memory>
#include <vector>

#include "bespoke/clearance/detail/correction_graph.h"
#include "bespoke/clearance/detail/product_samples.h"
#include "bespoke/clearance/detail/smooth_correction.h"
#include "bespoke/clearance/prepared_product.h"
#include "bespoke/clearance/product_places.h"
#include "bespoke/clearance/source_places.h"
#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {

/// Samples of a product, and where they were on the source.
struct SourceSamples {
  SourceSamples(ProductSamples samples, const TriangleMesh& product);

  std::shared_ptr<const ProductSamples> samples;
  SourcePlaces places;
};

struct PreparedProduct::Data {
  Data(TriangleMesh product, const Eigen::Matrix2Xi& lines, const std::vector<int>& parts);

  TriangleMesh mesh;
  CorrectionGraph graph;
  SmoothCorrection energy;
  SourceSamples samples;  ///< that are constrained
  SourceSamples checks;   ///< that are looked at afterwards
  ProductPlaces places;
  std::vector<MeshEdge> edges;
};

}  // namespace bespoke
