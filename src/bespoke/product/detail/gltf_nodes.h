#pragma once

#include <string>
#include <vector>

#include "bespoke/product/detail/gltf_accessor.h"
#include "bespoke/types.h"

namespace bespoke {

/// A mesh where a node shows it.
struct GltfShown {
  std::size_t node = 0, mesh = 0;
  AffineMap scene_from_mesh;  ///< can be undone
};

struct GltfScene {
  std::vector<GltfShown> shown;
  std::vector<std::string> warnings;
};

/// The same bits for a point, whatever its neighbours.
Points in_scene(const AffineMap& scene_from_mesh, const Points& x);

/// The nodes of a name, and all below them.
std::vector<bool> nodes_below(const GltfFile& file, const std::string& name);

/// Which meshes the nodes show, and where. A skinned mesh is where its joints hold it in its bind pose, not
/// where its node is. Throws FormatError naming the JSON pointer at fault, and InvalidInput for instances.
GltfScene read_scene(const GltfFile& file, const std::vector<GltfAccessor>& accessors);

}  // namespace bespoke
