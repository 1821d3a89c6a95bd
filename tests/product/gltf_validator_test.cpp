#include <gmock/gmock.h>

#include "bespoke/product/gltf/document/gltf_file.h"
#include "product/rig_scene.h"

namespace bespoke {
namespace {

using nlohmann::json;
using test::GltfScene;
using ::testing::HasSubstr;

/// The Khronos validator's word on carried files.
class GltfValidator : public test::ProductFiles {
 protected:
  void SetUp() override {
    if (std::system("node " BESPOKE_GLTF_VALIDATOR " >/dev/null 2>&1") != 0)
      GTEST_SKIP() << "gltf-validator is not installed: install nodejs and npm, then run tools/setup";
  }

  std::string findings(const std::filesystem::path& path) const {
    const std::filesystem::path out = directory_ / "findings";
    const std::string command =
        std::string("node ") + BESPOKE_GLTF_VALIDATOR + " '" + path.string() + "' > " + out.string();
    EXPECT_EQ(std::system(command.c_str()), 0);
    return test::read_text(out);
  }

  /// Both the file and what it becomes have neither errors nor warnings.
  void expect_valid(const std::string& name, const std::string& content) {
    carried(name, content, test::bend_motion());
    EXPECT_THAT(findings(directory_ / name), HasSubstr("0 errors, 0 warnings"));
    EXPECT_THAT(findings(directory_ / ("out_" + name)), HasSubstr("0 errors, 0 warnings"));
  }
};

TEST_F(GltfValidator, AcceptsACopiedMeshWithAMorphTarget) {
  GltfScene scene = test::morphing_triangle();
  scene.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {1, 0, 0}}}};
  scene.root["scenes"] = {{{"nodes", {0, 1}}}};
  expect_valid("a.glb", scene.glb());
}

TEST_F(GltfValidator, AcceptsBuffersBesideAndInside) {
  GltfScene scene = test::morphing_triangle();
  file("a.bin", scene.data);
  expect_valid("a.gltf", scene.gltf("a.bin"));
  expect_valid("b.gltf", scene.gltf(data_uri_of("data:application/gltf-buffer;base64,", scene.data)));
}

TEST_F(GltfValidator, AcceptsUnpackedPositionsAndQuantisedNormals) {
  GltfScene scene;
  const int positions = scene.accessor(std::vector<std::int16_t>{0, 0, 0, 1, 0, 0, 0, 2, 0}, "VEC3", 5122,
                                       {{"min", {0, 0, 0}}, {"max", {1, 2, 0}}});
  const int normals = scene.accessor(std::vector<std::int8_t>{0, 0, 127, 0, 0, 127, 0, 0, 127}, "VEC3", 5120,
                                     {{"normalized", true}});
  for (json& view : scene.root["bufferViews"]) view["target"] = 34962;
  scene.root["extensionsUsed"] = scene.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  scene.root["meshes"] = {
      {{"primitives", {{{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}}}}}};
  scene.root["nodes"] = {{{"mesh", 0}}};
  scene.root["scenes"] = {{{"nodes", {0}}}};
  expect_valid("a.glb", scene.glb());
}

TEST_F(GltfValidator, AcceptsACarriedSkeleton) {
  test::RigScene rig;
  rig.scene.root.erase("extensionsUsed");
  rig.scene.root.erase("extensions");
  expect_valid("a.glb", rig.glb());
}

TEST_F(GltfValidator, AcceptsAProductOnAnotherSkeleton) {
  test::RigScene rig;
  const std::string target = file("target.glb", rig.glb());
  rig.scene.root.erase("extensionsUsed");
  rig.scene.root.erase("extensions");
  carry_product(file("a.glb", rig.glb()), {directory_ / "out.glb"}, test::bend_motion(),
                {{}, {}, nullptr, ModelPose::shown, target});
  EXPECT_THAT(findings(directory_ / "out.glb"), HasSubstr("0 errors, 0 warnings"));
}

}  // namespace
}  // namespace bespoke
