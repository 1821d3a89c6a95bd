#include <gmock/gmock.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "product/product_files.h"

namespace bespoke {
namespace {

using nlohmann::json;
using CarryGltf = test::ProductFiles;
using test::affine_motion;
using test::bend_motion;
using test::bytes;
using test::identity_motion;
using ::testing::HasSubstr;

/// Collects the bytes of accessors and their JSON.
class Scene {
 public:
  json root = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  std::string data;

  template <class Value>
  int accessor(const std::vector<Value>& values, const std::string& type, int component, json more = {}) {
    const int size = type == "VEC3" ? 3 : type == "VEC4" ? 4 : 1;
    data.resize((data.size() + 3) / 4 * 4, '\0');
    root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", data.size()}});
    const std::size_t begin = data.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
      data += bytes(values[i]);
      // Vectors of vertex attributes begin at multiples of four bytes.
      if (size > 1 && (i + 1) % static_cast<std::size_t>(size) == 0)
        data.resize((data.size() + 3) / 4 * 4, '\0');
    }
    json& view = root["bufferViews"].back();
    view["byteLength"] = data.size() - begin;
    if (size > 1) view["byteStride"] = (sizeof(Value) * static_cast<std::size_t>(size) + 3) / 4 * 4;
    json own = {{"bufferView", root["bufferViews"].size() - 1},
                {"componentType", component},
                {"count", values.size() / static_cast<std::size_t>(size)},
                {"type", type}};
    if (!more.is_null()) own.update(more);
    root["accessors"].push_back(own);
    return static_cast<int>(root["accessors"].size()) - 1;
  }

  std::string glb() {
    data.resize((data.size() + 3) / 4 * 4, '\0');
    root["buffers"] = {{{"byteLength", data.size()}}};
    std::string text = root.dump(1);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return "glTF" + bytes(2u) + bytes(static_cast<std::uint32_t>(28 + text.size() + data.size())) +
           bytes(static_cast<std::uint32_t>(text.size())) + "JSON" + text +
           bytes(static_cast<std::uint32_t>(data.size())) + std::string("BIN\0", 4) + data;
  }
};

const std::vector<float> corners{0, 0, 0, 1, 0, 0, 0, 2, 0};
const json corner_bounds = {{"min", {0, 0, 0}}, {"max", {1, 2, 0}}};

/// A triangle with normals, tangents, a morph target and a second texture set, shown by one node.
Scene rich_scene() {
  Scene scene;
  json attributes = {{"POSITION", scene.accessor(corners, "VEC3", 5126, corner_bounds)}};
  attributes["NORMAL"] = scene.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 5126);
  attributes["TANGENT"] =
      scene.accessor(std::vector<float>{1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, 1}, "VEC4", 5126);
  const json morph = {{"POSITION", scene.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 0, 0}, "VEC3", 5126,
                                                  {{"min", {0, 0, 0}}, {"max", {1, 0, 0}}})}};
  scene.root["meshes"] = {
      {{"primitives", {{{"attributes", attributes}, {"targets", {morph}}}}}, {"name", "thing"}}};
  scene.root["nodes"] = {{{"mesh", 0}}};
  scene.root["scenes"] = {{{"nodes", {0}}}};
  return scene;
}

/// What a .glb holds.
struct Glb {
  explicit Glb(const std::string& content) {
    std::uint32_t length = 0;
    std::memcpy(&length, content.data() + 12, 4);
    root = json::parse(content.substr(20, length));
    data = content.substr(28 + length);
  }
  std::vector<float> floats(std::size_t accessor) const {
    const json& own = root["accessors"][accessor];
    const json& view = root["bufferViews"][own["bufferView"].get<std::size_t>()];
    const std::size_t size = own["type"] == "VEC4" ? 4 : 3;
    std::vector<float> values(size * own["count"].get<std::size_t>());
    for (std::size_t i = 0; i < values.size(); ++i)
      std::memcpy(&values[i],
                  data.data() + view.value("byteOffset", 0) + own.value("byteOffset", 0) +
                      i / size * view.value("byteStride", 4 * size) + i % size * 4,
                  4);
    return values;
  }
  json root;
  std::string data;
};

TEST_F(CarryGltf, WithTheIdentityKeepsEveryByte) {
  Scene scene = rich_scene();
  scene.root["nodes"] = {{{"children", {1, 2}}, {"rotation", {0.1, 0.2, 0.3, 0.9273618495495703}}},
                         {{"mesh", 0}, {"translation", {1000.1, 2, 3}}, {"scale", {2, 0.3, -1}}},
                         {{"mesh", 0}, {"matrix", {2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}}};
  scene.root["extras"] = {{"text", "braces ] } \\\" in text"}, {"number", 1e-3}};
  const std::string whole = scene.glb() + bytes(4u) + "ABCD" + "more";
  std::string glb = whole;
  glb.replace(8, 4, bytes(static_cast<std::uint32_t>(glb.size())));
  EXPECT_EQ(carried("a.glb", glb, identity_motion()), glb);
}

TEST_F(CarryGltf, MovesPositionsNormalsTangentsAndMorphTargets) {
  const Glb out(carried("a.glb", rich_scene().glb(), bend_motion()));
  const float r = static_cast<float>(std::sqrt(0.5));
  EXPECT_EQ(out.floats(0), (std::vector<float>{0, 0, 0, 1, 0, 0.5, 0, 2, 0}));
  EXPECT_EQ(out.floats(1), (std::vector<float>{0, 0, 1, -r, 0, r, 0, 0, 1}));
  EXPECT_EQ(out.floats(2), (std::vector<float>{1, 0, 0, -1, r, 0, r, -1, 1, 0, 0, 1}));
  // The second corner morphs from x = 1 to x = 2, where the bend is 2 instead of 0.5.
  EXPECT_EQ(out.floats(3), (std::vector<float>{0, 0, 0, 1, 0, 1.5, 0, 0, 0}));
  EXPECT_EQ(out.root["accessors"][0]["max"], json({1, 2, 0.5}));
  EXPECT_EQ(out.root["accessors"][3]["max"], json({1, 0, 1.5}));
  EXPECT_EQ(out.root["meshes"], rich_scene().root["meshes"]);
  EXPECT_EQ(summary_.points, 6u);
}

TEST_F(CarryGltf, MovesInTheSceneAndNotInTheMesh) {
  Scene scene = rich_scene();
  // A quarter turn about z takes the mesh's y to -x of the scene; scaled by 2 and moved by 3.
  const double half = std::sqrt(0.5);
  scene.root["nodes"] = {
      {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"scale", {2, 2, 2}}, {"translation", {3, 0, 0}}}};
  const std::vector<float> out = Glb(carried("a.glb", scene.glb(), bend_motion())).floats(0);
  // Scene x of the corners: 3, 3, 3 − 4 = −1; bends of 4.5, 4.5, 0.5; half of that in the mesh.
  const std::vector<double> expected{0, 0, 2.25, 1, 0, 2.25, 0, 2, 0.25};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(out[i], expected[i], 1e-6) << i;
}

TEST_F(CarryGltf, CopiesAMeshThatIsShownInSeveralPlaces) {
  Scene scene = rich_scene();
  scene.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {1, 0, 0}}}, {{"mesh", 0}}};
  scene.root["scenes"] = {{{"nodes", {0, 1, 2}}}};
  const Glb out(carried("a.glb", scene.glb(), bend_motion()));
  EXPECT_EQ(out.root["nodes"][0]["mesh"], 0);
  EXPECT_EQ(out.root["nodes"][1]["mesh"], 1);
  EXPECT_EQ(out.root["nodes"][2]["mesh"], 0);
  ASSERT_EQ(out.root["meshes"].size(), 2u);
  const std::size_t copy = out.root["meshes"][1]["primitives"][0]["attributes"]["POSITION"];
  EXPECT_EQ(out.floats(0), (std::vector<float>{0, 0, 0, 1, 0, 0.5, 0, 2, 0}));
  EXPECT_EQ(out.floats(copy), (std::vector<float>{0, 0, 0.5, 1, 0, 2, 0, 2, 0.5}));
  EXPECT_EQ(out.root["accessors"][copy]["max"], json({1, 2, 2}));
}

TEST_F(CarryGltf, UnpacksSparseAndQuantisedPositionsOnlyWhereTheyChange) {
  for (const bool is_sparse : {true, false}) {
    Scene scene;
    if (is_sparse) {
      scene.accessor(corners, "VEC3", 5126, corner_bounds);
      scene.accessor(std::vector<std::uint16_t>{2}, "SCALAR", 5123);
      scene.accessor(std::vector<float>{2, 2, 0}, "VEC3", 5126);
      scene.root["accessors"][0]["sparse"] = {{"count", 1},
                                              {"indices", {{"bufferView", 1}, {"componentType", 5123}}},
                                              {"values", {{"bufferView", 2}}}};
      scene.root["accessors"][0]["max"] = {2, 2, 0};
    } else {
      scene.accessor(std::vector<std::int16_t>{0, 0, 0, 1, 0, 0, 2, 2, 0}, "VEC3", 5122,
                     {{"min", {0, 0, 0}}, {"max", {2, 2, 0}}});
      scene.root["extensionsUsed"] = scene.root["extensionsRequired"] = {"KHR_mesh_quantization"};
    }
    scene.root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}};
    scene.root["nodes"] = {{{"mesh", 0}}};
    scene.root["scenes"] = {{{"nodes", {0}}}};
    const std::string glb = scene.glb();
    EXPECT_EQ(carried("a.glb", glb, identity_motion()), glb);
    const Glb out(carried("a.glb", glb, bend_motion()));
    EXPECT_EQ(out.root["accessors"][0]["componentType"], 5126);
    EXPECT_FALSE(out.root["accessors"][0].contains("sparse"));
    EXPECT_EQ(out.floats(0), (std::vector<float>{0, 0, 0, 1, 0, 0.5, 2, 2, 2}));
  }
}

TEST_F(CarryGltf, ReadsBuffersBesideAndInside) {
  Scene scene = rich_scene();
  const std::string glb = scene.glb();
  const std::string expected = Glb(carried("a.glb", glb, bend_motion())).data;
  scene.root["buffers"][0]["uri"] = "some%20data.bin";
  file("some data.bin", scene.data);
  carried("a.gltf", scene.root.dump(), bend_motion());
  EXPECT_EQ(test::read_text(directory_ / "out_a.bin"), expected);
  EXPECT_EQ(json::parse(test::read_text(directory_ / "out_a.gltf"))["buffers"][0]["uri"], "out_a.bin");
  EXPECT_EQ(summary_.companions.size(), 1u);
  scene.root["buffers"][0]["byteLength"] = 6;
  scene.root["buffers"][0]["uri"] = "data:application/octet-stream;base64,AAECA/8=";
  EXPECT_THAT(complaint("a.gltf", scene.root.dump()), HasSubstr("a.gltf: /buffers/0: has 5 of 6 bytes"));
}

TEST_F(CarryGltf, WarnsOfSkins) {
  Scene scene = rich_scene();
  scene.root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {9, 0, 0}}}, {{"name", "joint"}}};
  scene.root["skins"] = {{{"joints", {1}}}};
  const Glb out(carried("a.glb", scene.glb(), bend_motion()));
  EXPECT_EQ(out.floats(0), (std::vector<float>{0, 0, 0, 1, 0, 0.5, 0, 2, 0}));
  EXPECT_THAT(summary_.warnings, ::testing::ElementsAre(HasSubstr("bind pose")));
}

TEST_F(CarryGltf, NamesThePlaceOfWhatIsWrong) {
  const std::string whole = rich_scene().glb();
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(complaint("short.glb", whole.substr(0, size)), "accepted") << size;
  const auto broken = [&](const json& patch) {
    Scene scene = rich_scene();
    scene.glb();
    scene.root = scene.root.patch(patch);
    scene.root.erase("buffers");
    return complaint("a.glb", scene.glb());
  };
  const auto replaced = [&](const std::string& pointer, const json& value) {
    return broken({{{"op", "replace"}, {"path", pointer}, {"value", value}}});
  };
  EXPECT_THAT(replaced("/accessors/0/count", 4),
              HasSubstr("a.glb: /accessors/0: ends behind its buffer view"));
  EXPECT_THAT(replaced("/accessors/0/count", 1u << 31), HasSubstr("/accessors/0: ends behind"));
  EXPECT_THAT(replaced("/accessors/0/bufferView", 99),
              HasSubstr("/accessors/0/bufferView: there is no such"));
  EXPECT_THAT(replaced("/accessors/0/componentType", 5124),
              HasSubstr("/accessors/0/componentType: is unknown"));
  EXPECT_THAT(replaced("/bufferViews/0/byteLength", 1u << 30),
              HasSubstr("/bufferViews/0: ends behind its buffer"));
  EXPECT_THAT(replaced("/nodes/0/mesh", 1), HasSubstr("/nodes/0/mesh: names nothing"));
  EXPECT_THAT(replaced("/nodes", {{{"children", {0}}, {"mesh", 0}}}),
              HasSubstr("/nodes/0: is its own ancestor"));
  EXPECT_THAT(replaced("/nodes/0", {{"mesh", 0}, {"scale", {1, 0, 1}}}), HasSubstr("cannot be undone"));
  EXPECT_THAT(replaced("/meshes/0/primitives/0/attributes/NORMAL", 2), HasSubstr("/accessors/2/type"));
  EXPECT_THAT(replaced("/accessors/0/normalized", {}), ::testing::Ne("accepted"));
  EXPECT_THAT(complaint("a.gltf", "{\"asset\": }"), HasSubstr("a.gltf: byte 11 of the JSON"));
}

TEST_F(CarryGltf, GivesWhatTheKhronosValidatorAccepts) {
  const std::string script =
      "const fs=require('fs'),v=require('gltf-validator');"
      "v.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1]))).then(r=>{"
      "console.log(JSON.stringify(r.issues.messages));process.exit(r.issues.numErrors>0?1:0)})";
  if (std::system("node -e \"require('gltf-validator')\" >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "no node with the package gltf-validator here";
  Scene scene = rich_scene();
  scene.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {1, 0, 0}}}};
  scene.root["scenes"] = {{{"nodes", {0, 1}}}};
  carried("a.glb", scene.glb(), bend_motion());
  for (const char* name : {"a.glb", "out_a.glb"})
    EXPECT_EQ(std::system(("node -e \"" + script + "\" " + (directory_ / name).string()).c_str()), 0) << name;
}

}  // namespace
}  // namespace bespoke
