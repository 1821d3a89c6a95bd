#include "bespoke/product/gltf/scene/gltf_nodes.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr double agreement = 1e-4;  // of two skins about the place of a joint, as of joints about a mesh's

/// Joints of skins that nodes use, and all nodes below them.
std::vector<bool> rigged_nodes(const GltfScene& scene) {
  std::vector<bool> is_rigged(scene.nodes.order.size());
  for (const auto& [skin, pose] : scene.poses)
    for (const std::size_t joint : pose.joints) is_rigged[joint] = true;
  for (const std::size_t node : scene.nodes.order)
    if (const auto parent = scene.nodes.parent[node]; parent && is_rigged[*parent]) is_rigged[node] = true;
  return is_rigged;
}

/// Nodes in the pose in which meshes are stored: joints where the meshes were bound to them.
class StoredPose {
 public:
  StoredPose(const GltfFile& file, const GltfScene& scene)
      : nodes_(file.root().elements("nodes")), scene_(scene), places_(nodes_.size()) {}

  void add(const GltfPose& pose, const AffineMap& scene_from_mesh) {
    for (std::size_t i = 0; i < pose.joints.size(); ++i) {
      const GltfPart& node = nodes_[pose.joints[i]];
      if (!is_invertible(pose.joint_from_mesh[i])) node.fail("is bound flat, which cannot be undone");
      const AffineMap place = composed(scene_from_mesh, inverse_of(pose.joint_from_mesh[i]));
      std::optional<AffineMap>& known = places_[pose.joints[i]];
      if (known && !((known->linear - place.linear).norm() <= agreement * place.linear.norm() &&
                     (known->offset - place.offset).norm() <=
                         agreement * (place.offset.norm() + scene_from_mesh.offset.norm())))
        throw InvalidInput(node.path().string() + ": " + node.pointer() +
                           ": is a joint of skins that are stored in different poses; take the pose that is "
                           "shown");
      if (!known) known = place;
    }
  }

  std::vector<AffineMap> scene_from_node() const {
    std::vector<AffineMap> result = scene_.nodes.scene_from_node;
    for (const std::size_t node : scene_.nodes.order) {
      if (!scene_.is_rigged[node]) continue;
      const auto parent = scene_.nodes.parent[node];
      if (places_[node])
        result[node] = *places_[node];
      else if (parent)
        result[node] = composed(result[*parent], scene_.nodes.local[node]);
    }
    return result;
  }

 private:
  std::vector<GltfPart> nodes_;
  const GltfScene& scene_;
  std::vector<std::optional<AffineMap>> places_;
};

/// Meshes whose joints hold them in another pose than they are stored in are where their nodes place them.
void take_as_stored(const GltfFile& file, GltfScene& scene) {
  if (scene.posed == 0) return;
  StoredPose stored(file, scene);
  std::vector<GltfPose*> is_stored;
  for (GltfShown& shown : scene.shown) {
    if (!shown.skin) continue;
    GltfPose& pose = scene.poses.at(*shown.skin);
    const AffineMap& node = scene.nodes.scene_from_node[shown.node];
    if (pose.is_bind_pose) {
      stored.add(pose, shown.scene_from_mesh);
      continue;
    }
    stored.add(pose, node);
    shown.scene_from_mesh = node;
    shown.pose.reset();
    pose.scene_from_mesh.assign(pose.joints.size(), node);
    is_stored.push_back(&pose);
  }
  for (GltfPose* const pose : is_stored) pose->is_bind_pose = true;
  scene.posed = 0;
  scene.scene_from_node = stored.scene_from_node();
}

/// Whose mesh is nowhere yet.
GltfShown read_shown(const GltfFile& file, const GltfPart& node, std::size_t meshes) {
  if (node.has("extensions") && node.member("extensions").has("EXT_mesh_gpu_instancing"))
    throw InvalidInput(file.path.string() + ": " + node.pointer() +
                       ": shows instances (EXT_mesh_gpu_instancing); make them nodes first");
  GltfShown shown;
  shown.mesh = *node.index("mesh", meshes);
  return shown;
}

}  // namespace

GltfPlacement placement(const GltfFile& file, const GltfScene& scene, const GltfShown& shown,
                        const GltfPart& primitive, const std::vector<GltfAccessor>& accessors) {
  if (!shown.pose) return {shown.scene_from_mesh, {}, shown.holder};
  return {{}, skinned_vertices(file, primitive, scene.poses.at(*shown.pose), accessors), {}};
}

Points in_scene(const GltfPlacement& placement, const Points& x, std::size_t first) {
  Points y(3, x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    y.col(i) = placement.at(first + static_cast<std::size_t>(i)) * Vector3(x.col(i));
  return y;
}

std::vector<bool> nodes_below(const GltfFile& file, const std::string& name) {
  const std::vector<GltfPart> nodes = file.root().elements("nodes");
  std::vector<bool> is_below(nodes.size());
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].has("name") && nodes[i].text("name") == name) open.push_back(i);
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    if (is_below[node]) continue;
    is_below[node] = true;
    for (const std::size_t child : nodes[node].indices("children", nodes.size())) open.push_back(child);
  }
  return is_below;
}

GltfScene read_scene(const GltfFile& file, const std::vector<GltfAccessor>& accessors, ModelPose pose) {
  const std::vector<GltfPart> nodes = file.root().elements("nodes");
  const std::vector<GltfPart> skins = file.root().elements("skins");
  const std::size_t meshes = file.root().elements("meshes").size();
  GltfScene scene;
  scene.nodes = read_hierarchy(file);
  scene.scene_from_node = scene.nodes.scene_from_node;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto skin = nodes[i].index("skin", skins.size());
    if (!nodes[i].index("mesh", meshes)) continue;
    GltfShown shown = read_shown(file, nodes[i], meshes);
    shown.node = i;
    shown.scene_from_mesh = scene.scene_from_node[i];
    shown.skin = skin;
    if (skin && !scene.poses.contains(*skin))
      scene.poses[*skin] = read_pose(file, skins[*skin], scene.scene_from_node, accessors);
    if (skin) {
      GltfPose& own = scene.poses.at(*skin);
      shown.scene_from_mesh = own.is_bind_pose ? own.scene_from_mesh.front() : AffineMap();
      if (own.is_bind_pose)
        own.scene_from_mesh.assign(own.joints.size(), shown.scene_from_mesh);
      else
        shown.pose = skin;
    }
    scene.posed += shown.pose.has_value();
    scene.shown.push_back(std::move(shown));
  }
  scene.is_rigged = rigged_nodes(scene);
  if (pose == ModelPose::stored) take_as_stored(file, scene);
  for (GltfShown& shown : scene.shown) {
    if (!shown.skin && scene.is_rigged[shown.node]) {
      shown.holder = shown.node;
      shown.scene_from_mesh = scene.scene_from_node[shown.node];
    }
    if (!is_invertible(shown.scene_from_mesh))
      nodes[shown.node].fail("places its mesh flat, which cannot be undone");
  }
  return scene;
}

}  // namespace bespoke
