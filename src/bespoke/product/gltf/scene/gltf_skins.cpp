#include "bespoke/product/gltf/scene/gltf_skins.h"

#include <cmath>
#include <string>

namespace bespoke {
namespace {

// Joints hold a mesh in its bind pose where they agree this well about its place, relative to the sizes that
// are added up: far above the rounding of the file's floats, far below any pose.
constexpr double pose_tolerance = 1e-4;

constexpr std::size_t joints_of_a_set = 4;

/// JOINTS_k or WEIGHTS_k, one column a vertex.
GltfValues skin_attribute(const GltfFile& file, const GltfPart& attributes, const std::string& name,
                          const std::vector<GltfAccessor>& accessors) {
  const auto index = attributes.index(name.c_str(), accessors.size());
  if (!index) attributes.fail("has no " + name + ", though its node has a skin");
  const GltfAccessor& found = accessors[*index];
  const auto positions = attributes.index("POSITION", accessors.size());
  if (found.components != joints_of_a_set || (positions && found.count != accessors[*positions].count))
    attributes.fail_at(name.c_str(), "is not four values for every position");
  return read_values(found, file.buffers, 0, found.count);
}

}  // namespace

GltfPose read_pose(const GltfFile& file, const GltfPart& skin, const std::vector<AffineMap>& scene_from_node,
                   const std::vector<GltfAccessor>& accessors) {
  const std::vector<std::size_t> joints = skin.indices("joints", scene_from_node.size());
  const auto inverse_binds = skin.index("inverseBindMatrices", accessors.size());
  if (joints.empty()) skin.fail_at("joints", "are none");
  GltfValues matrices = GltfValues(Eigen::Matrix4f::Identity().reshaped()).replicate(1, joints.size());
  if (inverse_binds) {
    if (accessors[*inverse_binds].components != 16 || accessors[*inverse_binds].count < joints.size())
      skin.fail_at("inverseBindMatrices", "is not one matrix a joint");
    matrices = read_values(accessors[*inverse_binds], file.buffers, 0, joints.size());
  }
  GltfPose pose;
  pose.joints = joints;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const AffineMap& joint = scene_from_node[joints[i]];
    const Eigen::Matrix4d matrix = matrices.col(static_cast<Eigen::Index>(i)).cast<double>().reshaped(4, 4);
    const AffineMap bind = affine_of(matrix);
    pose.joint_from_mesh.push_back(bind);
    pose.scene_from_mesh.push_back(composed(joint, bind));
    const AffineMap &held = pose.scene_from_mesh.back(), &first = pose.scene_from_mesh.front();
    const double reach = joint.offset.norm() + joint.linear.norm() * bind.offset.norm();
    pose.is_bind_pose = pose.is_bind_pose &&
                        (held.linear - first.linear).norm() <= pose_tolerance * first.linear.norm() &&
                        (held.offset - first.offset).norm() <= pose_tolerance * reach;
  }
  return pose;
}

GltfWeights read_weights(const GltfFile& file, const GltfPart& primitive, std::size_t joint_count,
                         const std::vector<GltfAccessor>& accessors) {
  const GltfPart attributes = primitive.member("attributes");
  std::vector<GltfValues> joints, weights;
  for (std::size_t set = 0;; ++set) {
    const std::string number = std::to_string(set);
    if (set > 0 && !attributes.has(("JOINTS_" + number).c_str())) break;
    joints.push_back(skin_attribute(file, attributes, "JOINTS_" + number, accessors));
    weights.push_back(skin_attribute(file, attributes, "WEIGHTS_" + number, accessors));
  }
  GltfWeights result;
  for (Eigen::Index vertex = 0; vertex < joints.front().cols(); ++vertex) {
    const auto joint_at = [&](std::size_t set, Eigen::Index k) {
      const float joint = joints[set](k, vertex);
      if (!(joint >= 0 && joint < static_cast<float>(joint_count)))
        attributes.fail("vertex " + std::to_string(vertex) + " names a joint that the skin has not");
      return static_cast<std::uint32_t>(joint);
    };
    for (std::size_t set = 0; set < joints.size(); ++set)
      for (Eigen::Index k = 0; k < weights[set].rows(); ++k) {
        const auto weight = static_cast<double>(weights[set](k, vertex));
        if (!(weight >= 0 && std::isfinite(weight)))
          attributes.fail("vertex " + std::to_string(vertex) + " has a weight below 0 or not finite");
        if (weight > 0) result.weights.push_back({joint_at(set, k), weight});
      }
    if (result.weights.size() == result.start.back()) result.weights.push_back({joint_at(0, 0), 1});
    result.start.push_back(result.weights.size());
  }
  return result;
}

std::vector<AffineMap> skinned_vertices(const GltfFile& file, const GltfPart& primitive, const GltfPose& pose,
                                        const std::vector<GltfAccessor>& accessors) {
  const GltfWeights all = read_weights(file, primitive, pose.scene_from_mesh.size(), accessors);
  std::vector<AffineMap> maps;
  maps.reserve(all.start.size() - 1);
  for (std::size_t vertex = 0; vertex + 1 < all.start.size(); ++vertex) {
    AffineMap sum{Matrix3::Zero(), Vector3::Zero()};
    double total = 0;
    for (std::size_t k = all.start[vertex]; k < all.start[vertex + 1]; ++k) {
      const auto& [joint, weight] = all.weights[k];
      sum.linear += weight * pose.scene_from_mesh[joint].linear;
      sum.offset += weight * pose.scene_from_mesh[joint].offset;
      total += weight;
    }
    maps.push_back({sum.linear / total, sum.offset / total});
  }
  return maps;
}

}  // namespace bespoke
