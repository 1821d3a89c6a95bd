#include "bespoke/product/gltf/scene/gltf_hierarchy.h"

#include <algorithm>
#include <cmath>

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

}  // namespace

AffineMap composed(const AffineMap& a, const AffineMap& b) { return {a.linear * b.linear, a * b.offset}; }

AffineMap inverse_of(const AffineMap& map) {
  const Matrix3 linear = map.linear.inverse();
  return {linear, -(linear * map.offset)};
}

AffineMap affine_of(const Eigen::Matrix4d& matrix) {
  return {matrix.topLeftCorner<3, 3>(), matrix.topRightCorner<3, 1>()};
}

bool is_invertible(const AffineMap& map) {
  const double determinant = map.linear.determinant();
  return std::abs(determinant) > 0 && std::isfinite(1 / determinant);
}

bool is_same(const AffineMap& a, const AffineMap& b) { return a.linear == b.linear && a.offset == b.offset; }

GltfHierarchy read_hierarchy(const GltfFile& file) {
  const std::vector<GltfPart> nodes = file.root().elements("nodes");
  GltfHierarchy result;
  result.parent.resize(nodes.size());
  std::vector<std::vector<std::size_t>> children;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    children.push_back(nodes[i].indices("children", nodes.size()));
    for (const std::size_t child : children.back()) {
      if (result.parent[child]) nodes[child].fail("is the child of two nodes");
      result.parent[child] = i;
    }
  }
  result.local.resize(nodes.size());
  result.scene_from_node.resize(nodes.size());
  std::vector<std::size_t>& order = result.order;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (!result.parent[i]) order.push_back(i);
  for (std::size_t at = 0; at < order.size(); ++at) {
    const std::size_t node = order[at];
    const AffineMap local = result.local[node] = local_transform(nodes[node]);
    const auto parent = result.parent[node];
    result.scene_from_node[node] = parent ? composed(result.scene_from_node[*parent], local) : local;
    order.insert(order.end(), children[node].begin(), children[node].end());
  }
  if (order.size() == nodes.size()) return result;
  std::sort(order.begin(), order.end());
  std::size_t missing = 0;  // whoever has no root above it is in a circle, or below one
  while (missing < order.size() && order[missing] == missing) ++missing;
  nodes[missing].fail("is below itself");
}

}  // namespace bespoke
