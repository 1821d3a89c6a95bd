#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "bespoke/mapping/affine_map.h"
#include "bespoke/product/gltf/document/gltf_file.h"
#include "bespoke/types.h"

namespace bespoke {

/// The nodes of a file as trees; one entry a node.
struct GltfHierarchy {
  std::vector<std::optional<std::size_t>> parent;
  std::vector<std::size_t> order;  ///< all nodes, parents before their children
  std::vector<AffineMap> local;    ///< into the parent, or into the scene
  std::vector<AffineMap> scene_from_node;
};

/// Throws FormatError naming the JSON pointer at fault.
GltfHierarchy read_hierarchy(const GltfFile& file);

/// (a ∘ b)(x) = a(b(x)).
AffineMap composed(const AffineMap& a, const AffineMap& b);
AffineMap inverse_of(const AffineMap& map);
AffineMap affine_of(const Eigen::Matrix4d& matrix);

/// Whether the map can be undone.
bool is_invertible(const AffineMap& map);

/// To the last bit.
bool is_same(const AffineMap& a, const AffineMap& b);

}  // namespace bespoke
