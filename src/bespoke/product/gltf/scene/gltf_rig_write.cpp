#include "bespoke/product/gltf/scene/gltf_rig_write.h"

#include <map>
#include <optional>
#include <utility>

namespace bespoke {
namespace {

GltfJson numbers(const Eigen::Ref<const Eigen::VectorXd>& values) {
  GltfJson result = GltfJson::array();
  for (const double value : values) result.push_back(value);
  return result;
}

/// How often meshes, skins and animations name every accessor.
std::vector<std::size_t> count_uses(const GltfFile& file, std::size_t accessors) {
  std::vector<std::size_t> uses(accessors);
  const auto use = [&](const GltfPart& part, const char* key) {
    if (const auto index = part.index(key, accessors)) ++uses[*index];
  };
  for (const GltfPart& mesh : file.root().elements("meshes"))
    for (const GltfPart& primitive : mesh.elements("primitives")) {
      use(primitive, "indices");
      std::vector<GltfPart> lists = primitive.elements("targets");
      lists.push_back(primitive.member("attributes"));
      for (const GltfPart& list : lists)
        for (const std::string& name : list.names()) use(list, name.c_str());
    }
  for (const GltfPart& skin : file.root().elements("skins")) use(skin, "inverseBindMatrices");
  for (const GltfPart& animation : file.root().elements("animations"))
    for (const GltfPart& sampler : animation.elements("samplers"))
      for (const char* key : {"input", "output"}) use(sampler, key);
  return uses;
}

class RigWriter {
 public:
  RigWriter(const GltfFile& file, const std::vector<GltfAccessor>& accessors, const GltfScene& scene,
            const GltfCarriedRig& rig, GltfFrame& frame)
      : file_(file),
        accessors_(accessors),
        scene_(scene),
        rig_(rig),
        frame_(frame),
        uses_(count_uses(file, accessors.size())),
        shares_(shares_bytes(accessors)) {}

  void run() {
    for (std::size_t node = 0; node < rig_.nodes.size(); ++node)
      if (scene_.is_rigged[node]) write_node(node);
    for (const auto& [skin, pose] : scene_.poses) write_skin(skin, pose);
    const std::vector<GltfPart> animations = file_.root().elements("animations");
    for (std::size_t i = 0; i < animations.size(); ++i) write_animation(i, animations[i]);
  }

 private:
  static bool turns(const GltfCarriedNode& node) { return node.local_turn != Matrix3::Identity(); }
  static Vector3 shift(const GltfCarriedNode& node, const Vector3& by) {
    return node.scale * (node.shift_turn * by);
  }

  void write_node(std::size_t index) {
    const GltfCarriedNode& carried = rig_.nodes[index];
    const AffineMap& rest = scene_.nodes.local[index];
    GltfJson& node = frame_.json()["nodes"][index];
    Vector3 translation = rest.offset;
    if (carried.moves_translations())
      translation = carried.translation + shift(carried, rest.offset - carried.translation_before);
    if (node.contains("matrix")) {
      if (translation == rest.offset && !turns(carried)) return;
      Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
      matrix.topLeftCorner<3, 3>() = carried.local_turn * rest.linear;
      matrix.topRightCorner<3, 1>() = translation;
      node["matrix"] = numbers(matrix.reshaped());
      return;
    }
    if (translation != rest.offset) node["translation"] = numbers(translation);
    if (!turns(carried)) return;
    const Eigen::VectorXd q = GltfPart(file_.path, node, "/nodes/" + std::to_string(index))
                                  .numbers("rotation", Eigen::Vector4d(0, 0, 0, 1));
    const Eigen::Quaterniond turned =
        Eigen::Quaterniond(carried.local_turn) * Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
    node["rotation"] = numbers(turned.normalized().coeffs());
  }

  /// Where nothing else has these values, and where they can be replaced.
  std::optional<std::size_t> own_place(std::size_t accessor) const {
    if (uses_[accessor] > 1 || shares_[accessor]) return std::nullopt;
    return accessor;
  }

  void write_skin(std::size_t index, const GltfPose& pose) {
    bool is_changed = !pose.is_bind_pose;
    for (const std::size_t joint : pose.joints)
      is_changed = is_changed || !is_same(rig_.nodes[joint].scene_from_node, scene_.scene_from_node[joint]);
    if (!is_changed) return;
    const GltfPart skin = file_.root().elements("skins")[index];
    const auto accessor = skin.index("inverseBindMatrices", accessors_.size());
    const std::size_t count = accessor ? accessors_[*accessor].count : pose.joints.size();
    GltfValues matrices = accessor ? read_values(accessors_[*accessor], file_.buffers, 0, count)
                                   : GltfValues(16, static_cast<Eigen::Index>(count));
    for (std::size_t i = 0; i < pose.joints.size(); ++i) {
      const AffineMap bind = carried_inverse_bind(rig_.nodes[pose.joints[i]],
                                                  pose.is_bind_pose ? pose.scene_from_mesh[i] : AffineMap());
      Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
      matrix.topLeftCorner<3, 3>() = bind.linear;
      matrix.topRightCorner<3, 1>() = bind.offset;
      matrices.col(static_cast<Eigen::Index>(i)) = matrix.cast<float>().reshaped();
    }
    const auto place = accessor ? own_place(*accessor) : std::nullopt;
    const std::size_t result = frame_.store_data(place, "MAT4", std::move(matrices));
    if (result != accessor) frame_.json()["skins"][index]["inverseBindMatrices"] = result;
  }

  void write_animation(std::size_t index, const GltfPart& animation) {
    const std::vector<GltfPart> samplers = animation.elements("samplers");
    const std::vector<GltfPart> channels = animation.elements("channels");
    std::vector<std::size_t> uses(samplers.size());
    for (const GltfPart& channel : channels)
      if (const auto sampler = channel.index("sampler", samplers.size())) ++uses[*sampler];
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const auto sampler = channels[c].index("sampler", samplers.size());
      const GltfPart target = channels[c].member("target");
      const auto node = target.index("node", rig_.nodes.size());
      if (!sampler || !node || !scene_.is_rigged[*node]) continue;
      const std::string path = target.text("path");
      const GltfCarriedNode& carried = rig_.nodes[*node];
      const bool is_rotation = path == "rotation" && turns(carried);
      if (!is_rotation && !(path == "translation" && carried.moves_translations())) continue;
      write_channel(index, c, samplers[*sampler], {*sampler, uses[*sampler] > 1}, carried, is_rotation);
    }
  }

  struct SamplerUse {
    std::size_t sampler = 0;
    bool is_shared = false;  ///< by channels
  };

  void write_channel(std::size_t animation, std::size_t channel, const GltfPart& sampler, SamplerUse use,
                     const GltfCarriedNode& carried, bool is_rotation) {
    const auto output = sampler.index("output", accessors_.size());
    if (!output) sampler.fail("has no output");
    const GltfAccessor& accessor = accessors_[*output];
    if (accessor.components != (is_rotation ? 4 : 3))
      sampler.fail_at("output", is_rotation ? "is no VEC4 of rotations" : "is no VEC3 of translations");
    GltfValues values = read_values(accessor, file_.buffers, 0, accessor.count);
    const bool is_cubic = sampler.has("interpolation") && sampler.text("interpolation") == "CUBICSPLINE";
    if (is_rotation)
      turn(carried, values);
    else
      shift_all(carried, is_cubic, values);
    GltfJson& json = frame_.json()["animations"][animation];
    const std::size_t result = frame_.store_data(use.is_shared ? std::nullopt : own_place(*output),
                                                 accessor.type, std::move(values));
    if (result == *output) return;
    if (use.is_shared) {
      GltfJson own = json["samplers"][use.sampler];
      json["samplers"].push_back(std::move(own));
      use.sampler = json["samplers"].size() - 1;
      json["channels"][channel]["sampler"] = use.sampler;
    }
    json["samplers"][use.sampler]["output"] = result;
  }

  /// Products of quaternions are linear in each, so tangents turn alike.
  static void turn(const GltfCarriedNode& carried, GltfValues& values) {
    const Eigen::Quaterniond by(carried.local_turn);
    for (Eigen::Index i = 0; i < values.cols(); ++i) {
      const Eigen::Vector4d q = values.col(i).cast<double>();
      values.col(i) = (by * Eigen::Quaterniond(q)).coeffs().cast<float>();
    }
  }

  /// Of a cubic spline the first and the last of three values are tangents.
  static void shift_all(const GltfCarriedNode& carried, bool is_cubic, GltfValues& values) {
    for (Eigen::Index i = 0; i < values.cols(); ++i) {
      const bool is_tangent = is_cubic && i % 3 != 1;
      const Vector3 before = is_tangent ? Vector3(Vector3::Zero()) : carried.translation_before;
      const Vector3 after = is_tangent ? Vector3(Vector3::Zero()) : carried.translation;
      values.col(i) = (after + shift(carried, values.col(i).cast<double>() - before)).cast<float>();
    }
  }

  const GltfFile& file_;
  const std::vector<GltfAccessor>& accessors_;
  const GltfScene& scene_;
  const GltfCarriedRig& rig_;
  GltfFrame& frame_;
  std::vector<std::size_t> uses_;
  std::vector<bool> shares_;
};

}  // namespace

void write_rig(const GltfFile& file, const std::vector<GltfAccessor>& accessors, const GltfScene& scene,
               const GltfCarriedRig& rig, GltfFrame& frame) {
  RigWriter(file, accessors, scene, rig, frame).run();
}

std::vector<std::string> rig_warnings(const GltfFile& file) {
  for (const GltfPart& animation : file.root().elements("animations"))
    for (const GltfPart& channel : animation.elements("channels"))
      if (channel.member("target").has("path") && channel.member("target").text("path") == "pointer")
        return {
            "animations that name what they move by pointers (KHR_animation_pointer) were left as they are"};
  return {};
}

}  // namespace bespoke
