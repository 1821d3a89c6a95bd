#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bespoke/clearance/keep_clear.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/product/model_pose.h"
#include "bespoke/product/rigid_part.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// A product's file as clearance needs it. Prepared once, for every target.
struct WornProduct {
  std::string name;
  std::shared_ptr<const PreparedProduct> prepared;
  std::vector<int> part_of_vertex;  ///< for each vertex the number of its part, or -1; or empty
  std::vector<RigidPart> parts;
};

/// Reads the faces and lines, without splits, of skinned meshes in that pose. `scale`: how many units of the
/// map one of the file is; what comes back is in the map's. Throws as read_product and parts_of_places.
WornProduct read_worn_product(const std::filesystem::path& file, const std::vector<RigidPart>& parts = {},
                              double scale = 1, ModelPose pose = ModelPose::shown);

/// The vertices of the product where a map takes them (3×n, target frame), those of its parts by the motion
/// of least squares of each.
Points carried_vertices(const WornProduct& product, const ElasticMap& elastic,
                        const RigidTransform& target_from_source);

/// How two products of a call lie to each other, as pairs of faces that pass through each other.
struct LayerContact {
  std::string lower, upper;
  std::size_t before = 0;  ///< on the source: left as they are
  std::size_t after = 0;   ///< that were none on the source
};

/// "shirt.obj under jacket.obj: 3 pairs of faces passed through each other on the source and are left, 0
/// new".
std::string to_string(const LayerContact& contact);

/// All that was found on one product.
struct ProductClearance {
  std::string product;
  ClearanceSummary summary;
  std::vector<LayerContact> layers;  ///< with every layer below it

  bool is_clear() const;
};

/// Of two products on the source and on the target (3×n each).
LayerContact layer_contact(const WornProduct& lower, const Points& lower_after, const WornProduct& upper,
                           const Points& upper_after);

}  // namespace bespoke
