#pragma once

#include <filesystem>
#include <vector>

#include "bespoke/mapping/mapping.h"
#include "bespoke/product/morph_product.h"
#include "bespoke/product/product_io.h"

namespace bespoke {

/// A product on its way along Ψ(t), in straight pieces.
struct MorphingMesh {
  Product product;              ///< at t = 0
  std::vector<Points> targets;  ///< its vertices at t = 1/n, 2/n, …, 1
  double off_path = 0;  ///< how far a vertex lies from its path at most, half way between targets, mesh units
};

/// The product at `targets` (> 0) evenly spaced times besides 0. Throws InvalidInput for a product without
/// faces, for no targets, and as apply_mapping.
MorphingMesh morph_along(Product product, const ElasticMap& elastic, const RigidTransform& target_from_source,
                         int targets, const MotionOptions& motion = {});

struct MorphOptions {
  int targets = 1;  ///< > 0
  MotionOptions motion = {};
  Progress progress = {};
};

/// The same of a .glb, which keeps all that it has (morph_product): writes `output`. Its scene's lengths are
/// taken as mesh units. Throws as morph_product and apply_mapping.
MorphSummary morph_file_along(const std::filesystem::path& input, const std::filesystem::path& output,
                              const ElasticMap& elastic, const RigidTransform& target_from_source,
                              const MorphOptions& options);

/// Seconds that an animation takes from t = 0 to 1.
inline constexpr double seconds_of_morphing = 2;

}  // namespace bespoke
