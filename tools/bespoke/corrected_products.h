#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bespoke/quality/mapping_quality.h"
#include "clearance_option.h"

namespace bespoke::command {

/// How products of a call are read and kept clear.
struct ProductsAsWorn {
  std::vector<std::string> files;
  std::string unit;               ///< of their coordinates, where it is given
  std::optional<ModelPose> pose;  ///< of skinned products
  ClearanceOption clearance;
  PartsOfProducts parts = {};  ///< that keep their shape

  bool is_as_mapped() const { return !clearance.is_used() && parts.empty(); }
  ModelPose pose_or_shown() const { return pose.value_or(ModelPose::shown); }
};

/// Products where --clearance takes them and parts that keep their shape, in their order; or empty.
struct CorrectedProducts {
  std::vector<Points> places;           ///< 3×n, target frame
  std::vector<ProductClearance> found;  ///< empty without --clearance
  std::optional<LayerOrder> order;
};

/// `products`: the files as they were read, in the unit of the map.
CorrectedProducts corrected_products(const ProductsAsWorn& worn, const std::vector<NamedProduct>& products,
                                     const OpenedMap& map);

}  // namespace bespoke::command
