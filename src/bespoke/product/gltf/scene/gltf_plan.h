#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bespoke/product/gltf/scene/gltf_nodes.h"

namespace bespoke {

/// What an accessor holds that is carried.
enum class GltfRole { position, normal, tangent };

/// One accessor to be carried.
struct GltfTask {
  GltfRole role = GltfRole::position;
  std::size_t positions = 0;              ///< accessor of the vertices
  std::size_t base = 0;                   ///< accessor of the role's values
  std::optional<std::size_t> difference;  ///< accessor of a morph target: differences from the base
  std::optional<std::size_t> difference_of_positions;  ///< of the same morph target, where it has one
  std::size_t place = 0;                               ///< in the plan
  std::size_t result = 0;                              ///< accessor that the carried values belong to

  std::size_t source() const { return difference.value_or(base); }
  bool is_copy() const { return result != source(); }
};

/// Which accessors are carried, and from where.
struct GltfPlan {
  GltfScene scene;
  std::vector<GltfPlacement> places;  ///< from meshes into the scene; can be undone
  std::vector<GltfTask> tasks;
  GltfJson json;  ///< with copies of meshes and accessors where one is used in several ways
  std::vector<std::string> warnings;
};

/// Throws FormatError naming the JSON pointer at fault, and InvalidInput for compressed meshes.
GltfPlan plan_gltf(const GltfFile& file, const std::vector<GltfAccessor>& accessors,
                   ModelPose pose = ModelPose::shown);

}  // namespace bespoke
