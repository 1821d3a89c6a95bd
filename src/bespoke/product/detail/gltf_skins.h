#pragma once

#include <vector>

#include "bespoke/product/detail/gltf_accessor.h"
#include "bespoke/types.h"

namespace bespoke {

/// How the joints of a skin hold its meshes in the pose in which the file's nodes stand.
struct GltfPose {
  std::vector<AffineMap> scene_from_mesh;  ///< of every joint: its place in the scene ∘ its inverse bind
  bool is_bind_pose = true;                ///< they agree, so that a mesh is shown as it is stored
};

/// Throws FormatError naming the JSON pointer at fault.
GltfPose read_pose(const GltfFile& file, const GltfPart& skin, const std::vector<AffineMap>& scene_from_node,
                   const std::vector<GltfAccessor>& accessors);

/// From the mesh into the scene at every vertex of a primitive, by linear blend skinning as glTF 2.0 defines
/// it (3.7.3.3): the mean of its joints' maps by its weights. Throws FormatError naming the JSON pointer at
/// fault, also where a primitive names no joints.
std::vector<AffineMap> skinned_vertices(const GltfFile& file, const GltfPart& primitive, const GltfPose& pose,
                                        const std::vector<GltfAccessor>& accessors);

/// (a ∘ b)(x) = a(b(x)).
AffineMap composed(const AffineMap& a, const AffineMap& b);
AffineMap affine_of(const Eigen::Matrix4d& matrix);

/// Whether the map can be undone.
bool is_invertible(const AffineMap& map);

}  // namespace bespoke
