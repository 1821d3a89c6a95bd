#include "bespoke/product/detail/gltf_nodes.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {
namespace {

AffineMap local_transform(const GltfPart& node) {
  if (node.has("matrix"))
    return affine_of(
        Eigen::Map<const Eigen::Matrix4d>(node.numbers("matrix", Eigen::VectorXd::Zero(16)).eval().data()));
  const Eigen::VectorXd q = node.numbers("rotation", Eigen::Vector4d(0, 0, 0, 1));
  const Eigen::VectorXd scale = node.numbers("scale", Eigen::VectorXd::Ones(3));
  AffineMap map;
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  if (!(rotation.norm() > 0)) node.fail_at("rotation", "has no axis");
  // The identity stays so to the last bit.
  if (rotation.vec() != Vector3::Zero()) map.linear = rotation.normalized().toRotationMatrix();
  map.linear = (map.linear * scale.asDiagonal()).eval();
  map.offset = node.numbers("translation", Eigen::VectorXd::Zero(3));
  return map;
}

/// From every node into the scene.
std::vector<AffineMap> scene_transforms(const std::vector<GltfPart>& nodes) {
  std::vector<std::optional<std::size_t>> parent(nodes.size());
  std::vector<std::vector<std::size_t>> children;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    children.push_back(nodes[i].indices("children", nodes.size()));
    for (const std::size_t child : children.back()) {
      if (parent[child]) nodes[child].fail("is the child of two nodes");
      parent[child] = i;
    }
  }
  std::vector<AffineMap> scene_from_node(nodes.size());
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (!parent[i]) order.push_back(i);
  for (std::size_t at = 0; at < order.size(); ++at) {
    const std::size_t node = order[at];
    const AffineMap local = local_transform(nodes[node]);
    scene_from_node[node] = parent[node] ? composed(scene_from_node[*parent[node]], local) : local;
    order.insert(order.end(), children[node].begin(), children[node].end());
  }
  if (order.size() == nodes.size()) return scene_from_node;
  std::sort(order.begin(), order.end());
  std::size_t missing = 0;  // whoever has no root above it is in a circle, or below one
  while (missing < order.size() && order[missing] == missing) ++missing;
  nodes[missing].fail("is below itself");
}

}  // namespace

GltfPlacement placement(const GltfFile& file, const GltfScene& scene, const GltfShown& shown,
                        const GltfPart& primitive, const std::vector<GltfAccessor>& accessors) {
  if (!shown.pose) return {shown.scene_from_mesh, {}};
  return {{}, skinned_vertices(file, primitive, scene.poses.at(*shown.pose), accessors)};
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

GltfScene read_scene(const GltfFile& file, const std::vector<GltfAccessor>& accessors) {
  const std::vector<GltfPart> nodes = file.root().elements("nodes");
  const std::vector<GltfPart> skins = file.root().elements("skins");
  const std::size_t meshes = file.root().elements("meshes").size();
  const std::vector<AffineMap> scene_from_node = scene_transforms(nodes);
  GltfScene scene;
  std::size_t bound = 0, posed = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto mesh = nodes[i].index("mesh", meshes);
    const auto skin = nodes[i].index("skin", skins.size());
    if (!mesh) continue;
    if (nodes[i].has("extensions") && nodes[i].member("extensions").has("EXT_mesh_gpu_instancing"))
      throw InvalidInput(file.path.string() + ": " + nodes[i].pointer() +
                         ": shows instances (EXT_mesh_gpu_instancing); make them nodes first");
    GltfShown shown{i, *mesh, scene_from_node[i], {}};
    if (skin) {
      GltfPose pose = read_pose(file, skins[*skin], scene_from_node, accessors);
      shown.scene_from_mesh = pose.is_bind_pose ? pose.scene_from_mesh.front() : AffineMap();
      ++(pose.is_bind_pose ? bound : posed);
      if (!pose.is_bind_pose) {
        shown.pose = *skin;
        scene.poses.try_emplace(*skin, std::move(pose));
      }
    }
    if (!is_invertible(shown.scene_from_mesh)) nodes[i].fail("places its mesh flat, which cannot be undone");
    scene.shown.push_back(std::move(shown));
  }
  if (bound > 0)
    scene.warnings.emplace_back("a skinned mesh was carried in its bind pose; its skin was left as it is");
  if (posed > 0)
    scene.warnings.emplace_back(
        "a skinned mesh was carried in the pose in which its nodes show it, which is not its bind pose; its "
        "skin was left as it is");
  return scene;
}

}  // namespace bespoke
