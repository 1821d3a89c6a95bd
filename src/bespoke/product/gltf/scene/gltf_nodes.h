#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/product/gltf/document/gltf_accessor.h"
#include "bespoke/product/gltf/scene/gltf_hierarchy.h"
#include "bespoke/product/gltf/scene/gltf_skins.h"
#include "bespoke/product/model_pose.h"
#include "bespoke/types.h"

namespace bespoke {

/// A mesh where a node shows it.
struct GltfShown {
  std::size_t node = 0, mesh = 0;
  AffineMap scene_from_mesh;          ///< can be undone; the identity with a pose
  std::optional<std::size_t> skin;    ///< whose joints hold it
  std::optional<std::size_t> pose;    ///< that skin, where joints hold vertices each in a place of its own
  std::optional<std::size_t> holder;  ///< the node, where it is a joint or below one and has no skin
};

struct GltfScene {
  std::vector<GltfShown> shown;
  std::map<std::size_t, GltfPose> poses;  ///< by the skins that nodes use; one map for all joints if it binds
  GltfHierarchy nodes;                    ///< as they stand
  std::vector<AffineMap> scene_from_node;  ///< in the pose that is requested
  std::vector<bool> is_rigged;             ///< of every node: a joint, or below one
  std::size_t posed = 0;                   ///< what is shown in another pose than it is stored in
};

/// Where the vertices of a primitive are shown.
struct GltfPlacement {
  AffineMap scene_from_mesh;
  std::vector<AffineMap> of_vertices;  ///< instead, one a vertex, for a mesh in a pose
  std::optional<std::size_t> holder;   ///< as of what is shown

  const AffineMap& at(std::size_t vertex) const {
    return of_vertices.empty() ? scene_from_mesh : of_vertices[vertex];
  }
};

/// Throws FormatError naming the JSON pointer at fault.
GltfPlacement placement(const GltfFile& file, const GltfScene& scene, const GltfShown& shown,
                        const GltfPart& primitive, const std::vector<GltfAccessor>& accessors);

/// Of vertices from number `first` on; the same bits for a point, whatever its neighbours.
Points in_scene(const GltfPlacement& placement, const Points& x, std::size_t first = 0);

/// The nodes of a name, and all below them.
std::vector<bool> nodes_below(const GltfFile& file, const std::string& name);

/// Which meshes the nodes show, and where. A skinned mesh is where its joints hold it, as the nodes stand,
/// not where its node is. Throws FormatError naming the JSON pointer at fault, and InvalidInput for
/// instances, and for skins that are stored in poses which contradict each other, if that pose is requested.
GltfScene read_scene(const GltfFile& file, const std::vector<GltfAccessor>& accessors,
                     ModelPose pose = ModelPose::shown);

}  // namespace bespoke
