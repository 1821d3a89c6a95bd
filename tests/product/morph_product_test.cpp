#include "bespoke/product/morph_product.h"

#include <gmock/gmock.h>

#include <cmath>

#include "product/gltf_scene.h"

namespace bespoke {
namespace {

using nlohmann::json;
using test::error_message;
using test::GlbContent;
using test::GltfScene;
using ::testing::HasSubstr;

using Floats = std::vector<float>;

/// A turn about z by half a turn at t = 1, with frames at t = 1/2n, …, 1.
PointMotion half_turn(std::size_t targets) {
  PointMotion motion;
  motion.frames = 2 * targets;
  const auto rotation = [targets](std::size_t frame) -> Matrix3 {
    const double t = static_cast<double>(frame + 1) / static_cast<double>(2 * targets);
    return Eigen::AngleAxisd(M_PI * t, Vector3::UnitZ()).toRotationMatrix();
  };
  motion.images = [=](const Points& x) {
    std::vector<Points> frames;
    for (std::size_t k = 0; k < 2 * targets; ++k) frames.push_back(rotation(k) * x);
    return frames;
  };
  motion.jacobians = [=](const Points& x) {
    std::vector<Points> frames;
    for (std::size_t k = 0; k < 2 * targets; ++k) frames.push_back(rotation(k).replicate(1, x.cols()));
    return frames;
  };
  return motion;
}

/// A triangle with normals, tangents, texture coordinates and a material.
GltfScene triangle() {
  GltfScene scene;
  json attributes;
  attributes["POSITION"] = scene.accessor(Floats{0, 0, 0, 1, 0, 0, 0, 2, 0}, "VEC3", 5126,
                                          {{"min", {0, 0, 0}}, {"max", {1, 2, 0}}});
  attributes["NORMAL"] = scene.accessor(Floats{0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 5126);
  attributes["TANGENT"] = scene.accessor(Floats{1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, 1}, "VEC4", 5126);
  attributes["TEXCOORD_0"] = scene.accessor(Floats{0, 0, 1, 0, 0, 1}, "VEC2", 5126);
  const int indices = scene.accessor(std::vector<std::uint16_t>{0, 1, 2}, "SCALAR", 5123);
  for (json& view : scene.root["bufferViews"]) view["target"] = 34962;
  scene.root["bufferViews"].back()["target"] = 34963;
  scene.root["materials"] = {{{"name", "wool"}, {"doubleSided", true}}};
  scene.root["meshes"] = {
      {{"name", "skirt"},
       {"primitives", {{{"attributes", attributes}, {"indices", indices}, {"material", 0}}}}}};
  scene.root["nodes"] = {{{"mesh", 0}}};
  scene.root["scenes"] = {{{"nodes", {0}}}};
  return scene;
}

class MorphProduct : public test::ProductFiles {
 protected:
  GlbContent morphed(const GltfScene& scene, std::size_t targets) {
    morph_ = morph_product(file("skirt.glb", GltfScene(scene).glb()), directory_ / "out.glb",
                           half_turn(targets), 2.0);
    return GlbContent(test::read_text(directory_ / "out.glb"));
  }
  static const json& primitive(const GlbContent& file, std::size_t mesh = 0) {
    return file.root["meshes"][mesh]["primitives"][0];
  }
  static Floats sum(const Floats& a, const Floats& b) {
    Floats result;
    for (std::size_t i = 0; i < a.size(); ++i) result.push_back(a[i] + b[i]);
    return result;
  }
  static void expect_near(const Floats& found, const Floats& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-6) << i;
  }

  MorphSummary morph_;
};

TEST_F(MorphProduct, BaseStaysAndTargetsAreTheMotion) {
  const GlbContent file = morphed(triangle(), 2);
  const json& own = primitive(file);
  const Floats x{0, 0, 0, 1, 0, 0, 0, 2, 0};
  EXPECT_EQ(file.floats(own["attributes"]["POSITION"]), x);
  expect_near(sum(x, file.floats(own["targets"][0]["POSITION"])), {0, 0, 0, 0, 1, 0, -2, 0, 0});
  expect_near(sum(x, file.floats(own["targets"][1]["POSITION"])), {0, 0, 0, -1, 0, 0, 0, -2, 0});
  expect_near(file.floats(own["targets"][1]["NORMAL"]), Floats(9, 0.0f));
  // Of tangents the direction, without the sign that is their fourth number.
  expect_near(file.floats(own["targets"][1]["TANGENT"]), {-2, 0, 0, -2, 0, 0, -2, 0, 0});
  EXPECT_EQ(file.root["meshes"][0]["weights"], json({0, 0}));
  EXPECT_EQ(file.root["meshes"][0]["extras"]["targetNames"], json({"t = 0.5", "t = 1"}));
  EXPECT_EQ(morph_.points, 3u);
  // The point at 2 from the axis, on the chord of a quarter turn.
  EXPECT_NEAR(morph_.off_path, 2 * (1 - std::cos(M_PI / 4)), 1e-6);
}

TEST_F(MorphProduct, KeepsMaterialsTextureCoordinatesAndNames) {
  const GltfScene scene = triangle();
  const GlbContent file = morphed(scene, 1);
  EXPECT_EQ(file.root["materials"], scene.root["materials"]);
  EXPECT_EQ(primitive(file)["attributes"], scene.root["meshes"][0]["primitives"][0]["attributes"]);
  EXPECT_EQ(primitive(file)["material"], 0);
  EXPECT_EQ(file.root["meshes"][0]["name"], "skirt");
  EXPECT_EQ(file.data.substr(0, scene.data.size()), scene.data);
}

TEST_F(MorphProduct, AnimatesEveryNodeThatShowsIt) {
  GltfScene scene = triangle();
  scene.root["nodes"] = {{{"name", "camera"}}, {{"mesh", 0}}, {{"mesh", 0}, {"translation", {0, 0, 5}}}};
  scene.root["scenes"] = {{{"nodes", {0, 1, 2}}}};
  const GlbContent file = morphed(scene, 3);
  const json& animation = file.root["animations"][0];
  ASSERT_EQ(animation["channels"].size(), 2u);
  EXPECT_EQ(animation["channels"][0]["target"], json({{"node", 1}, {"path", "weights"}}));
  EXPECT_EQ(animation["channels"][1]["target"]["node"], 2);
  EXPECT_EQ(file.floats(animation["samplers"][0]["output"]), (Floats{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(file.floats(animation["samplers"][0]["input"]).back(), 2);
  // Two meshes with targets of their own, and one base.
  ASSERT_EQ(file.root["meshes"].size(), 2u);
  EXPECT_EQ(primitive(file, 1)["attributes"], primitive(file)["attributes"]);
  EXPECT_NE(primitive(file, 1)["targets"], primitive(file)["targets"]);
}

// A node that scales by 2 shows a turn in the scene, which is the same turn in the mesh.
TEST_F(MorphProduct, MovesMeshesWhereTheirNodesShowThem) {
  GltfScene scene = triangle();
  scene.root["nodes"][0]["scale"] = {2, 2, 2};
  const GlbContent file = morphed(scene, 1);
  expect_near(file.floats(primitive(file)["targets"][0]["POSITION"]), {0, 0, 0, -2, 0, 0, 0, -4, 0});
  EXPECT_NEAR(morph_.off_path, 4, 1e-6) << "in the scene";
}

TEST_F(MorphProduct, RefusesWhatItCannotMorph) {
  const auto complaint = [&](const std::string& name, const std::string& content, std::size_t frames) {
    PointMotion motion = half_turn(1);
    motion.frames = frames;
    const std::string path = file(name, content);
    return error_message<InvalidInput>([&] { morph_product(path, directory_ / "out.glb", motion, 2.0); });
  };
  EXPECT_THAT(complaint("a.glb", test::morphing_triangle().glb(), 2), HasSubstr("morph targets of its own"));
  EXPECT_THAT(complaint("a.gltf", triangle().gltf("a.bin"), 2), HasSubstr("must end in .glb"));
  EXPECT_THAT(complaint("a.glb", triangle().glb(), 3), HasSubstr("3 frames"));
  EXPECT_FALSE(std::filesystem::exists(directory_ / "out.glb"));
}

TEST_F(MorphProduct, IsValidToKhronos) {
  if (std::system("node " BESPOKE_GLTF_VALIDATOR " >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "gltf-validator is not installed: install nodejs and npm, then run tools/setup";
  GltfScene scene = triangle();
  scene.root["nodes"].push_back({{"mesh", 0}, {"translation", {0, 0, 5}}});
  scene.root["scenes"] = {{{"nodes", {0, 1}}}};
  morphed(scene, 3);
  const std::filesystem::path findings = directory_ / "findings";
  const std::string command = std::string("node ") + BESPOKE_GLTF_VALIDATOR + " '" +
                              (directory_ / "out.glb").string() + "' > " + findings.string();
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_THAT(test::read_text(findings), HasSubstr("0 errors, 0 warnings"));
}

}  // namespace
}  // namespace bespoke
