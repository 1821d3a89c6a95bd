#pragma once

#include <cmath>
#include <numbers>

#include "bespoke/product/product_io.h"
#include "product/gltf_scene.h"

namespace bespoke::test {

/// A sleeve along x from 0 to 4 on two joints, "upper" at x = 0 and "lower" at x = 2, whose weights blend
/// over 0.5 around x = 2; "tip" hangs on the lower joint at x = 4 and holds nothing. The skeleton is below a
/// node that turns, shifts and halves, and the mesh is stored in its units. A morph target bulges the sleeve,
/// an animation bends and shifts it, and a button hangs on the lower joint without being skinned.
struct RigScene {
  static constexpr int rings = 17, corners = 8;
  static constexpr double bend = std::numbers::pi / 3;  ///< of the elbow, in the animation's last frame

  RigScene() {
    add_sleeve();
    add_button();
    add_nodes();
    add_animation();
    scene.root["extensionsUsed"] = {"VRMC_vrm"};
    scene.root["extensions"] = {{"VRMC_vrm", {{"humanoid", {{"leftLowerArm", 2}}}, {"odd", 1.50}}}};
  }

  static double radius(double x) { return 0.5 + 0.05 * std::sin(3 * x); }
  static double lower_weight(double x) { return std::clamp((x - 1.75) / 0.5, 0.0, 1.0); }

  std::string glb() { return scene.glb(); }

  GltfScene scene;
  int binds = 0, joints = 0, weights = 0, positions = 0, rotations = 0, translations = 0;

 private:
  /// Of the node above the skeleton: x ↦ R x / 2 + t, with R a quarter turn about z.
  static Vector3 stored(const Vector3& x_in_scene) {
    const Vector3 shifted = 2 * (x_in_scene - Vector3(1, 2, 3));
    return {shifted.y(), -shifted.x(), shifted.z()};
  }
  static void append(std::vector<float>& values, const Vector3& x) {
    for (const double value : x) values.push_back(static_cast<float>(value));
  }
  static nlohmann::json bounds(const std::vector<float>& values) {
    std::vector<float> least(values.begin(), values.begin() + 3), most = least;
    for (std::size_t i = 0; i < values.size(); ++i) {
      least[i % 3] = std::min(least[i % 3], values[i]);
      most[i % 3] = std::max(most[i % 3], values[i]);
    }
    return {{"min", least}, {"max", most}};
  }

  void add_sleeve() {
    std::vector<float> x, n, bulge, bulge_normals, held;
    std::vector<std::uint8_t> names;
    std::vector<std::uint16_t> faces;
    for (int ring = 0; ring < rings; ++ring)
      for (int k = 0; k < corners; ++k) {
        const double along = 4.0 * ring / (rings - 1), angle = 2 * std::numbers::pi * k / corners;
        const Vector3 out(0, std::cos(angle), std::sin(angle));
        append(x, stored(Vector3(along, 0, 0) + radius(along) * out));
        append(n, Vector3(out.y(), 0, out.z()));
        append(bulge, 0.1 * std::sin(along) * Vector3(out.y(), 0, out.z()));
        append(bulge_normals, Vector3(0.01, -0.02, 0.03));
        const double lower = lower_weight(along);
        for (const double weight : {1 - lower, lower, 0.0, 0.0}) held.push_back(static_cast<float>(weight));
        names.insert(names.end(), {0, std::uint8_t(lower > 0 ? 1 : 0), 0, 0});
      }
    for (int ring = 0; ring + 1 < rings; ++ring)
      for (int k = 0; k < corners; ++k) {
        const int a = ring * corners + k, b = ring * corners + (k + 1) % corners;
        for (const int index : {a, b, a + corners, b, b + corners, a + corners})
          faces.push_back(static_cast<std::uint16_t>(index));
      }
    positions = scene.accessor(x, "VEC3", 5126, bounds(x));
    nlohmann::json attributes = {{"POSITION", positions}, {"NORMAL", scene.accessor(n, "VEC3", 5126)}};
    attributes["JOINTS_0"] = joints = scene.accessor(names, "VEC4", 5121);
    attributes["WEIGHTS_0"] = weights = scene.accessor(held, "VEC4", 5126);
    const int difference = scene.accessor(bulge, "VEC3", 5126, bounds(bulge));
    const int of_normals = scene.accessor(bulge_normals, "VEC3", 5126);
    const int indices = scene.accessor(faces, "SCALAR", 5123);
    scene.root["meshes"].push_back({{"primitives",
                                     {{{"attributes", attributes},
                                       {"indices", indices},
                                       {"targets", {{{"POSITION", difference}, {"NORMAL", of_normals}}}}}}},
                                    {"weights", {0}},
                                    {"name", "sleeve"}});
  }

  void add_button() {
    const std::vector<float> x{0, 0, 0, 0.4f, 0, 0, 0, 0.4f, 0};
    scene.root["meshes"].push_back(
        {{"primitives", {{{"attributes", {{"POSITION", scene.accessor(x, "VEC3", 5126, bounds(x))}}}}}},
         {"name", "button"}});
  }

  void add_nodes() {
    const double half = std::sqrt(0.5);
    // "upper" turns by half a turn about x, in which "lower" and what is below stand.
    scene.root["nodes"] = {
        {{"name", "armature"},
         {"children", {1}},
         {"translation", {1, 2, 3}},
         {"rotation", {0, 0, half, half}},
         {"scale", {0.5, 0.5, 0.5}}},
        {{"name", "upper"}, {"children", {2}}, {"translation", {-4, 2, -6}}, {"rotation", {1, 0, 0, 0}}},
        {{"name", "lower"}, {"children", {3, 4}}, {"translation", {0, 4, 0}}},
        {{"name", "tip"}, {"translation", {0, 4, 0}}},
        {{"name", "button"}, {"mesh", 1}, {"translation", {0, 2, 1}}},
        {{"name", "sleeve"}, {"mesh", 0}, {"skin", 0}}};
    scene.root["scenes"] = {{{"nodes", {0, 5}}}};
    Eigen::Matrix4f upper = Eigen::Matrix4f::Identity();
    upper.topLeftCorner<3, 3>() = Eigen::Vector3f(1, -1, -1).asDiagonal();
    upper.topRightCorner<3, 1>() = -upper.topLeftCorner<3, 3>() * Eigen::Vector3f(-4, 2, -6);
    Eigen::Matrix4f lower = upper;
    lower(1, 3) -= 4;
    std::vector<float> matrices(upper.data(), upper.data() + 16);
    matrices.insert(matrices.end(), lower.data(), lower.data() + 16);
    binds = scene.accessor(matrices, "MAT4", 5126);
    scene.root["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", binds}, {"skeleton", 1}}};
  }

  void add_animation() {
    const float s = static_cast<float>(std::sin(bend / 2)), c = static_cast<float>(std::cos(bend / 2));
    const std::vector<float> turns{0, 0, 0, 1, 0, 0, s, c};
    const std::vector<float> shifts{-4, 2, -6, -3.5f, 2.25f, -7};
    const int input = scene.accessor(std::vector<float>{0, 1}, "SCALAR", 5126, {{"min", {0}}, {"max", {1}}});
    rotations = scene.accessor(turns, "VEC4", 5126);
    translations = scene.accessor(shifts, "VEC3", 5126);
    scene.root["animations"] = {
        {{"name", "bend"},
         {"samplers",
          {{{"input", input}, {"output", rotations}}, {{"input", input}, {"output", translations}}}},
         {"channels",
          {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}},
           {{"sampler", 1}, {"target", {{"node", 1}, {"path", "translation"}}}}}}}};
  }
};

/// The file as its first animation shows it at one of its keys.
inline std::string at_key(const GlbContent& file, std::size_t key) {
  GltfScene scene;
  scene.root = file.root;
  scene.data = file.data;
  const nlohmann::json& animation = file.root["animations"][0];
  for (const nlohmann::json& channel : animation["channels"]) {
    const nlohmann::json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
    const std::vector<float> values = file.floats(sampler["output"].get<std::size_t>());
    const std::string path = channel["target"]["path"];
    const std::size_t size = path == "rotation" ? 4 : 3;
    nlohmann::json value = nlohmann::json::array();
    for (std::size_t k = 0; k < size; ++k) value.push_back(values[key * size + k]);
    scene.root["nodes"][channel["target"]["node"].get<std::size_t>()][path] = value;
  }
  return scene.glb();
}

}  // namespace bespoke::test
