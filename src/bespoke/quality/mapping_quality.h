#pragma once

#include <string>
#include <vector>

#include "bespoke/progress.h"
#include "bespoke/quality/distortion.h"
#include "bespoke/quality/product_quality.h"
#include "bespoke/quality/surface_distance.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// A product as it is designed on the source.
struct NamedProduct {
  std::string name;
  TriangleMesh mesh;                 ///< polygons as triangles
  std::vector<int> line_edges = {};  ///< the ends of the edges of its polylines, by twos
};

struct MappingQualityInput {
  const TriangleMesh& source;
  const TriangleMesh& target;
  const ElasticMap& elastic;                 ///< E
  const RigidTransform& target_from_source;  ///< Γ; what is measured is Ψ(1) = Γ∘E
  const Points& anchor_sources;              ///< 3×k, may be empty
  const Points& anchor_targets;              ///< 3×k
  const std::vector<NamedProduct>& products;
  /// Where the vertices of each are taken, 3×n, target frame; empty where that is by Ψ(1).
  const std::vector<Points>& carried_products = {};
};

struct MappingQualityOptions {
  SurfaceDistanceOptions surfaces;
  MapDistortionOptions distortion;
  ProductQualityOptions products;
};

/// Numbers for what the paper could not measure ("our approach lacks metrics").
struct MappingQuality {
  Statistics anchor_residuals;  ///< |Ψ(1)(a) − b|, mesh units
  SurfaceDistance surfaces;     ///< a: the mapped source, b: the target
  MapDistortion distortion;     ///< of E
  std::size_t source_faces = 0;
  std::size_t flipped_faces = 0;         ///< of the source, see flipped_faces
  std::vector<ProductQuality> products;  ///< in the order of the input
};

/// Throws InvalidInput for meshes that are not valid, anchors whose numbers differ, non-finite products;
/// Interrupted.
MappingQuality mapping_quality(const MappingQualityInput& input, const MappingQualityOptions& options = {},
                               const Progress& progress = {});

}  // namespace bespoke
