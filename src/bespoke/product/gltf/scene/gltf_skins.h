#pragma once

#include <cstdint>
#include <vector>

#include "bespoke/product/gltf/document/gltf_accessor.h"
#include "bespoke/product/gltf/scene/gltf_hierarchy.h"
#include "bespoke/types.h"

namespace bespoke {

/// How the joints of a skin hold its meshes in the pose in which the file's nodes stand. One entry a joint.
struct GltfPose {
  std::vector<std::size_t> joints;         ///< nodes
  std::vector<AffineMap> joint_from_mesh;  ///< inverse binds
  std::vector<AffineMap> scene_from_mesh;  ///< the joint's place in the scene ∘ its inverse bind
  bool is_bind_pose = true;                ///< these agree, so that a mesh is shown as it is stored
};

/// Throws FormatError naming the JSON pointer at fault.
GltfPose read_pose(const GltfFile& file, const GltfPart& skin, const std::vector<AffineMap>& scene_from_node,
                   const std::vector<GltfAccessor>& accessors);

/// Which joints hold the vertices of a primitive, and how much: those of vertex i are [start[i], start[i+1]).
struct GltfWeights {
  struct Weight {
    std::uint32_t joint = 0;  ///< of the skin
    double weight = 0;        ///< above zero; a vertex's need not sum to one
  };
  std::vector<std::size_t> start{0};
  std::vector<Weight> weights;
};

/// A vertex without weights belongs to the first joint that it names, as viewers have it. Throws FormatError
/// naming the JSON pointer at fault, also where a primitive names no joints.
GltfWeights read_weights(const GltfFile& file, const GltfPart& primitive, std::size_t joints,
                         const std::vector<GltfAccessor>& accessors);

/// From the mesh into the scene at every vertex of a primitive, by linear blend skinning as glTF 2.0 defines
/// it (3.7.3.3): the mean of its joints' maps by its weights. Throws as read_weights.
std::vector<AffineMap> skinned_vertices(const GltfFile& file, const GltfPart& primitive, const GltfPose& pose,
                                        const std::vector<GltfAccessor>& accessors);

}  // namespace bespoke
