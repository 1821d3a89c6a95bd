#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <functional>

#include "bespoke/product/gltf/document/gltf_file.h"
#include "bespoke/product/product_io.h"
#include "product/gltf_scene.h"

namespace bespoke {
namespace {

using nlohmann::json;
using CarryGltf = test::ProductFiles;
using test::bend_motion;
using test::bytes;
using test::error_message;
using test::GlbContent;
using test::GltfScene;
using test::identity_motion;
using test::morphing_triangle;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Floats = std::vector<float>;

const Floats bent_corners{0, 0, 0, 1, 0, 0.5, 0, 2, 0};

TEST_F(CarryGltf, WithTheIdentityKeepsEveryByte) {
  GltfScene scene = morphing_triangle();
  scene.root["nodes"] = {{{"children", {1, 2}}, {"rotation", {0.1, 0.2, 0.3, 0.9273618495495703}}},
                         {{"mesh", 0}, {"translation", {1000.1, 2, 3}}, {"scale", {2, 0.3, -1}}},
                         {{"mesh", 0}, {"matrix", {2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}}};
  scene.root["extras"] = {{"text", "braces ] } \\\" in text"}, {"number", 1e-3}};
  std::string glb = scene.glb() + bytes(4u) + "ABCD" + "more";
  glb.replace(8, 4, bytes(static_cast<std::uint32_t>(glb.size())));
  EXPECT_EQ(carried("a.glb", glb, identity_motion()), glb);
  const std::string gltf = scene.gltf(data_uri_of("data:;base64,", scene.data));
  EXPECT_EQ(carried("a.gltf", gltf, identity_motion()), gltf);
}

TEST_F(CarryGltf, MovesPositionsNormalsTangentsAndMorphTargets) {
  const GlbContent out(carried("a.glb", morphing_triangle().glb(), bend_motion()));
  const float r = static_cast<float>(std::sqrt(0.5));
  EXPECT_EQ(out.floats(0), bent_corners);
  EXPECT_EQ(out.floats(1), (Floats{0, 0, 1, -r, 0, r, 0, 0, 1}));
  EXPECT_EQ(out.floats(2), (Floats{1, 0, 0, -1, r, 0, r, -1, 1, 0, 0, 1}));
  // The second corner morphs from x = 1 to x = 2, where the bend is 2 instead of 0.5.
  EXPECT_EQ(out.floats(3), (Floats{0, 0, 0, 1, 0, 1.5, 0, 0, 0}));
  EXPECT_EQ(out.root["accessors"][0]["max"], json({1, 2, 0.5}));
  EXPECT_EQ(out.root["accessors"][3]["max"], json({1, 0, 1.5}));
  EXPECT_EQ(out.root["meshes"], morphing_triangle().root["meshes"]);
  EXPECT_EQ(summary_.points, 6u);
  EXPECT_EQ(summary_.directions, 6u);
  EXPECT_THAT(summary_.warnings, ElementsAre());
}

TEST_F(CarryGltf, MorphsNormalsToThoseOfTheMorphedPlace) {
  GltfScene scene = morphing_triangle();
  json& primitive = scene.root["meshes"][0]["primitives"][0];
  primitive["targets"][0]["NORMAL"] = scene.accessor(Floats(9, 0.0f), "VEC3", 5126);
  const Floats out = GlbContent(carried("a.glb", scene.glb(), bend_motion())).floats(5);
  // At x = 1 the bend's slope is 1, at x = 2 it is 2.
  const Floats expected{
      0, 0, 0, float(std::sqrt(0.5) - 2 / std::sqrt(5)), 0, float(1 / std::sqrt(5) - std::sqrt(0.5)),
      0, 0, 0};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(out[i], expected[i], 1e-7) << i;
}

// Everything that a rich file holds is compared with what it was.
TEST_F(CarryGltf, ChangesNothingButGeometry) {
  GltfScene scene = morphing_triangle();
  json& primitive = scene.root["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = scene.accessor(Floats{0, 0, 1, 0, 0, 1}, "VEC2", 5126);
  primitive["attributes"]["TEXCOORD_1"] = scene.accessor(Floats{0.5, 0, 1, 0, 0, 1}, "VEC2", 5126);
  primitive["attributes"]["JOINTS_0"] =
      scene.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, "VEC4", 5121);
  primitive["attributes"]["WEIGHTS_0"] =
      scene.accessor(Floats{1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0}, "VEC4", 5126);
  const Floats identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  Floats matrices = identity;
  matrices.insert(matrices.end(), identity.begin(), identity.end());
  const int inverse_binds = scene.accessor(matrices, "MAT4", 5126);
  primitive["material"] = 0;
  scene.root["materials"] = {{{"name", "cloth"}, {"pbrMetallicRoughness", {{"roughnessFactor", 0.1}}}}};
  scene.root["nodes"] = {
      {{"mesh", 0}, {"skin", 0}, {"translation", {9.1, 0, 0}}}, {{"name", "hip"}}, {{"name", "knee"}}};
  scene.root["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse_binds}}};
  scene.root["scenes"][0]["nodes"] = {0, 1, 2};
  const GlbContent before(scene.glb());
  const GlbContent after(carried("a.glb", scene.glb(), bend_motion()));

  EXPECT_EQ(after.floats(0), bent_corners);  // in the bind pose, wherever the node is
  EXPECT_THAT(summary_.warnings, ::testing::IsEmpty());
  json root = after.root;
  root["nodes"][2].erase("rotation");  // the bend turns what the knee holds
  for (const std::size_t accessor : {0u, 3u})
    for (const char* bound : {"min", "max"})
      root["accessors"][accessor][bound] = before.root["accessors"][accessor][bound];
  EXPECT_EQ(root, before.root);
  ASSERT_EQ(after.data.size(), before.data.size());
  for (std::size_t byte = 0; byte < after.data.size(); ++byte)
    EXPECT_TRUE(after.data[byte] == before.data[byte] || byte < before.begin(4) ||
                byte >= before.begin(static_cast<std::size_t>(inverse_binds)))
        << byte;
}

TEST_F(CarryGltf, KeepsTheCharactersOfTheJsonButOfBounds) {
  std::string text = GlbContent(morphing_triangle().glb()).text;
  const std::string after = GlbContent(carried("a.glb", morphing_triangle().glb(), bend_motion())).text;
  std::size_t at = 0;
  for (const char* height : {"0.5", "1.5"}) {
    at = text.find("\"max\"", at + 1);
    text.replace(text.rfind('0', text.find(']', at)), 1, height);
  }
  text.resize(text.find_last_of('}') + 1);
  EXPECT_EQ(after.substr(0, after.find_last_of('}') + 1), text);
}

TEST_F(CarryGltf, MovesInTheSceneAndNotInTheMesh) {
  GltfScene scene = morphing_triangle();
  // A quarter turn about z takes the mesh's y to -x of the scene; scaled by 2 and moved by 3.
  const double half = std::sqrt(0.5);
  scene.root["nodes"] = {{{"children", {1}}, {"translation", {3, 0, 0}}},
                         {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"scale", {2, 2, 2}}}};
  const Floats out = GlbContent(carried("a.glb", scene.glb(), bend_motion())).floats(0);
  // Scene x of the corners: 3, 3, 3 − 4 = −1; bends of 4.5, 4.5, 0.5; half of that in the mesh.
  const std::vector<double> expected{0, 0, 2.25, 1, 0, 2.25, 0, 2, 0.25};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(out[i], expected[i], 1e-6) << i;
}

TEST_F(CarryGltf, CarriesASkinnedMeshWhereItsJointsHoldIt) {
  GltfScene scene = morphing_triangle();
  // A joint at x = 3, and vertices that are stored as seen from x = -2.
  const int bind = scene.accessor(Floats{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1}, "MAT4", 5126);
  scene.root["nodes"] = {
      {{"mesh", 0}, {"skin", 0}}, {{"translation", {3, 0, 0}}}, {{"translation", {5, 0, 0}}}};
  scene.root["skins"] = {{{"joints", {1}}, {"inverseBindMatrices", bind}}};
  EXPECT_EQ(GlbContent(carried("a.glb", scene.glb(), bend_motion())).floats(0),
            (Floats{0, 0, 2, 1, 0, 4.5, 0, 2, 2}));
}

/// A triangle whose corners are held by joint 0, by joint 1 and by both; joint 1 stands 4 farther in x than
/// in the pose of binding, so that a viewer shows the corners moved by 0, 4 and 2.
GltfScene posed_triangle() {
  GltfScene scene = morphing_triangle();
  json& attributes = scene.root["meshes"][0]["primitives"][0]["attributes"];
  scene.root["meshes"][0]["primitives"][0].erase("targets");
  attributes["JOINTS_0"] =
      scene.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, "VEC4", 5121);
  attributes["WEIGHTS_0"] = scene.accessor(Floats{1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0}, "VEC4", 5126);
  scene.root["nodes"] = {
      {{"mesh", 0}, {"skin", 0}, {"translation", {9, 9, 9}}}, json::object(), {{"translation", {4, 0, 0}}}};
  scene.root["skins"] = {{{"joints", {1, 2}}}};
  scene.root["scenes"][0]["nodes"] = {0, 1, 2};
  return scene;
}

TEST_F(CarryGltf, CarriesASkinnedMeshInAnotherPoseAsAViewerShowsIt) {
  const GlbContent out(carried("a.glb", posed_triangle().glb(), bend_motion()));
  // Shown at x = 0, 5 and 2, where the bend is 0, 12.5 and 2; it is bound in that pose.
  EXPECT_EQ(out.floats(0), (Floats{0, 0, 0, 5, 0, 12.5, 2, 2, 2}));
  const float length = std::sqrt(26.0f);
  EXPECT_NEAR(out.floats(1)[3], -5 / length, 1e-6);
  EXPECT_NEAR(out.floats(1)[5], 1 / length, 1e-6);
  EXPECT_THAT(summary_.warnings, ElementsAre(HasSubstr("in the pose in which its nodes show it")));
  EXPECT_EQ(out.root["skins"][0]["joints"], posed_triangle().root["skins"][0]["joints"]);
  const std::string glb = posed_triangle().glb();
  EXPECT_EQ(carried("a.glb", glb, identity_motion()), glb);
}

TEST_F(CarryGltf, ShowsASkinnedMeshWhereTheMapTakesIt) {
  GltfScene scene = posed_triangle();
  // A quarter turn of joint 1 about z: what it holds at (1, 0, 0) is shown at (0, 1, 0).
  const double half = std::sqrt(0.5);
  scene.root["nodes"][2] = {{"rotation", {0, 0, half, half}}};
  const Points before = read_product(file("a.glb", scene.glb())).vertices;
  EXPECT_LT((before.col(1) - Vector3(0, 1, 0)).norm(), 1e-6);
  const Points after = read_product(file("b.glb", carried("a.glb", scene.glb(), bend_motion()))).vertices;
  EXPECT_LT((after - bend_motion().images(before).front()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(CarryGltf, NamesWhatIsWrongWithASkin) {
  const auto fault = [&](const std::function<void(GltfScene&)>& spoil) {
    GltfScene scene = posed_triangle();
    spoil(scene);
    return complaint("a.glb", scene.glb());
  };
  const auto attributes = [](GltfScene& scene) -> json& {
    return scene.root["meshes"][0]["primitives"][0]["attributes"];
  };
  EXPECT_THAT(fault([&](GltfScene& scene) { attributes(scene).erase("JOINTS_0"); }),
              HasSubstr("/attributes: has no JOINTS_0, though its node has a skin"));
  EXPECT_THAT(fault([&](GltfScene& scene) {
                attributes(scene)["JOINTS_0"] = scene.accessor(
                    std::vector<std::uint8_t>{0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 5121);
              }),
              HasSubstr("vertex 1 names a joint that the skin has not"));
  EXPECT_THAT(fault([&](GltfScene& scene) {
                attributes(scene)["WEIGHTS_0"] =
                    scene.accessor(Floats{1, 0, 0, 0, 1, 0, 0, 0, -1, 0, 0, 0}, "VEC4", 5126);
              }),
              HasSubstr("vertex 2 has a weight below 0"));
  EXPECT_THAT(fault([&](GltfScene& scene) {  // half a turn and none cancel each other out
                scene.root["nodes"][2] = {{"scale", {-1, 1, 1}}};
              }),
              HasSubstr("its joints hold vertex 2 flat"));
}

TEST_F(CarryGltf, RefusesRequiredExtensionsThatItDoesNotKnow) {
  const auto refusal = [&](const std::string& extension) {
    GltfScene scene = morphing_triangle();
    scene.root["extensionsUsed"] = scene.root["extensionsRequired"] = {extension};
    return error_message<InvalidInput>([&] { carried("a.glb", scene.glb(), bend_motion()); });
  };
  EXPECT_THAT(refusal("EXT_not_known"), HasSubstr("a.glb: /extensionsRequired/0: requires EXT_not_known"));
  EXPECT_THAT(refusal("EXT_meshopt_compression"),
              HasSubstr("needs EXT_meshopt_compression: decompress it with gltfpack -noq or gltf-transform"));
  EXPECT_THAT(refusal("KHR_draco_mesh_compression"),
              HasSubstr("needs KHR_draco_mesh_compression: decompress it with gltf-transform"));
  for (const char* known : {"KHR_texture_basisu", "KHR_mesh_quantization", "KHR_materials_unlit"})
    EXPECT_EQ(refusal(known), "accepted") << known;
  // Of a compressed buffer that a reader without the extension would find empty.
  GltfScene scene = morphing_triangle();
  const std::string whole = scene.glb();
  const GlbContent content(whole);
  json root = content.root;
  root["buffers"].push_back(
      {{"byteLength", 44}, {"extensions", {{"EXT_meshopt_compression", json::object()}}}});
  std::string text = root.dump(1);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::string glb =
      "glTF" + bytes(2u) + bytes(static_cast<std::uint32_t>(28 + text.size() + content.data.size())) +
      bytes(static_cast<std::uint32_t>(text.size())) + "JSON" + text +
      bytes(static_cast<std::uint32_t>(content.data.size())) + std::string("BIN\0", 4) + content.data;
  EXPECT_THAT(error_message<InvalidInput>([&] { carried("a.glb", glb, bend_motion()); }),
              HasSubstr("/buffers/1: is compressed, needs EXT_meshopt_compression"));
}

TEST_F(CarryGltf, CopiesAMeshThatIsShownInSeveralPlaces) {
  GltfScene scene = morphing_triangle();
  scene.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {1, 0, 0}}}, {{"mesh", 0}}};
  scene.root["scenes"] = {{{"nodes", {0, 1, 2}}}};
  const GlbContent out(carried("a.glb", scene.glb(), bend_motion()));
  EXPECT_EQ(out.root["nodes"][0]["mesh"], 0);
  EXPECT_EQ(out.root["nodes"][1]["mesh"], 1);
  EXPECT_EQ(out.root["nodes"][2]["mesh"], 0);
  ASSERT_EQ(out.root["meshes"].size(), 2u);
  const std::size_t copy = out.root["meshes"][1]["primitives"][0]["attributes"]["POSITION"];
  EXPECT_EQ(out.floats(0), bent_corners);
  EXPECT_EQ(out.floats(copy), (Floats{0, 0, 0.5, 1, 0, 2, 0, 2, 0.5}));
  EXPECT_EQ(out.root["accessors"][copy]["max"], json({1, 2, 2}));
  EXPECT_EQ(out.root["meshes"][1]["primitives"][0]["indices"], 4);
}

TEST_F(CarryGltf, LeavesValuesThatSomethingElseUses) {
  GltfScene scene = morphing_triangle();
  // As an attribute of the application's own, in a mesh that no node shows, and in part by another accessor.
  scene.root["meshes"][0]["primitives"][0]["attributes"]["_REST"] = 0;
  scene.root["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", 1}}}}}}});
  json part = scene.root["accessors"][3];
  part["count"] = 2;
  part["byteOffset"] = 12;
  scene.root["accessors"].push_back(part);
  const GlbContent before(scene.glb());
  const GlbContent out(carried("a.glb", scene.glb(), bend_motion()));
  for (const std::size_t accessor : {0u, 1u, 3u})
    EXPECT_EQ(out.floats(accessor), before.floats(accessor)) << accessor;
  const json& attributes = out.root["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_EQ(out.floats(attributes["POSITION"]), bent_corners);
  EXPECT_EQ(attributes["_REST"], 0);
  EXPECT_THAT(summary_.warnings, ElementsAre(HasSubstr("no node shows were left as they are: 1")));
}

TEST_F(CarryGltf, UnpacksSparseAndQuantisedPositionsOnlyWhereTheyChange) {
  for (const bool is_sparse : {true, false}) {
    GltfScene scene;
    if (is_sparse) {
      scene.accessor(Floats{0, 0, 0, 1, 0, 0, 0, 2, 0}, "VEC3", 5126,
                     {{"min", {0, 0, 0}}, {"max", {2, 2, 0}}});
      scene.accessor(std::vector<std::uint16_t>{2}, "SCALAR", 5123);
      scene.accessor(Floats{2, 2, 0}, "VEC3", 5126);
      scene.root["accessors"][0]["sparse"] = {{"count", 1},
                                              {"indices", {{"bufferView", 1}, {"componentType", 5123}}},
                                              {"values", {{"bufferView", 2}}}};
      scene.root["accessors"].erase(2);
      scene.root["accessors"].erase(1);
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
    const GlbContent out(carried("a.glb", glb, bend_motion()));
    EXPECT_EQ(out.root["accessors"][0]["componentType"], 5126);
    EXPECT_FALSE(out.root["accessors"][0].contains("sparse"));
    EXPECT_EQ(out.floats(0), (Floats{0, 0, 0, 1, 0, 0.5, 2, 2, 2}));
  }
}

TEST_F(CarryGltf, KeepsASparseMorphTargetSparse) {
  GltfScene scene = morphing_triangle();
  const int at = scene.accessor(std::vector<std::uint8_t>{1}, "SCALAR", 5121);
  const int with = scene.accessor(Floats{1, 0, 0}, "VEC3", 5126);
  scene.root["accessors"][3] = {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}};
  scene.root["accessors"][3]["sparse"] = {{"count", 1},
                                          {"indices", {{"bufferView", at}, {"componentType", 5121}}},
                                          {"values", {{"bufferView", with}}}};
  scene.root["accessors"].erase(static_cast<std::size_t>(with));
  scene.root["accessors"].erase(static_cast<std::size_t>(at));
  const GlbContent before(scene.glb());
  const GlbContent out(carried("a.glb", scene.glb(), bend_motion()));
  EXPECT_EQ(out.root["accessors"][3], before.root["accessors"][3]);
  EXPECT_EQ(out.data.substr(out.data.size() - 12), bytes(1.0f) + bytes(0.0f) + bytes(1.5f));
}

TEST_F(CarryGltf, KeepsQuantisedNormalsSo) {
  GltfScene scene = morphing_triangle();
  scene.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = scene.accessor(
      std::vector<std::int8_t>{0, 0, 127, 0, 0, 127, 0, 0, 127}, "VEC3", 5120, {{"normalized", true}});
  const GlbContent out(carried("a.glb", scene.glb(), bend_motion()));
  EXPECT_EQ(out.root["accessors"][5], scene.root["accessors"][5]);
  // sqrt(1/2) of 127 is 89.8; a vector takes four bytes.
  EXPECT_EQ(out.data.substr(out.begin(5), 12),
            std::string("\x00\x00\x7f\x00\xa6\x00\x5a\x00\x00\x00\x7f\x00", 12));
}

// A rounded vector is not of unit length, which is not carried on: the cofactors make (-91, 91, 91) of the
// second one, and 127 / sqrt(3) is 73.3.
TEST_F(CarryGltf, RoundsQuantisedNormalsFromUnitLength) {
  GltfScene scene = morphing_triangle();
  scene.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = scene.accessor(
      std::vector<std::int8_t>{0, 91, 91, 0, 91, 91, 0, 91, 91}, "VEC3", 5120, {{"normalized", true}});
  const GlbContent out(carried("a.glb", scene.glb(), bend_motion()));
  EXPECT_EQ(out.data.substr(out.begin(5), 12),
            std::string("\x00\x5b\x5b\x00\xb7\x49\x49\x00\x00\x5b\x5b\x00", 12))
      << "the first and the last stay";
}

TEST_F(CarryGltf, ReadsBuffersBesideAndInside) {
  GltfScene scene = morphing_triangle();
  const std::string expected = GlbContent(carried("a.glb", scene.glb(), bend_motion())).data;
  file("some data.bin", scene.data);
  carried("a b.gltf", scene.gltf("some%20data.bin"), bend_motion());
  EXPECT_EQ(test::read_text(directory_ / "out_a b.bin"), expected);
  EXPECT_EQ(json::parse(test::read_text(directory_ / "out_a b.gltf"))["buffers"][0]["uri"], "out_a%20b.bin");
  EXPECT_THAT(summary_.companions, ElementsAre(directory_ / "out_a b.bin"));

  const json inside = json::parse(carried(
      "a.gltf", scene.gltf(data_uri_of("data:application/octet-stream;base64,", scene.data)), bend_motion()));
  EXPECT_EQ(inside["buffers"][0]["uri"], data_uri_of("data:application/octet-stream;base64,", expected));

  // An output whose buffer would replace the input's.
  file("out_c.bin", scene.data);
  EXPECT_THAT(error_message<InvalidInput>([&] { carried("c.gltf", scene.gltf("out_c.bin"), bend_motion()); }),
              HasSubstr("would be overwritten"));
  EXPECT_EQ(test::read_text(directory_ / "out_c.bin"), scene.data);
}

TEST_F(CarryGltf, WritesEveryFrame) {
  PointMotion motion = bend_motion();
  motion.frames = 2;
  const auto twice = [](const auto& of) {
    return [of](const Points& x) {
      return std::vector<Points>{of(x).front(), identity_motion().images(x).front()};
    };
  };
  motion.images = twice(bend_motion().images);
  motion.jacobians = [](const Points& x) {
    return std::vector<Points>{bend_motion().jacobians(x).front(), identity_motion().jacobians(x).front()};
  };
  const std::string glb = morphing_triangle().glb();
  carry_product(file("a.glb", glb), {directory_ / "b.glb", directory_ / "c.glb"}, motion);
  EXPECT_EQ(test::read_text(directory_ / "b.glb"), carried("a.glb", glb, bend_motion()));
  EXPECT_EQ(test::read_text(directory_ / "c.glb"), glb);
}

TEST_F(CarryGltf, RefusesWhatItCannotCarry) {
  const auto refusal = [&](GltfScene scene) {
    return error_message<InvalidInput>([&] { carried("a.glb", scene.glb(), bend_motion()); });
  };
  GltfScene scene = morphing_triangle();
  scene.root["meshes"][0]["primitives"][0]["extensions"] = {{"KHR_draco_mesh_compression", json::object()}};
  EXPECT_THAT(refusal(scene), HasSubstr("a.glb: /meshes/0/primitives/0: is compressed"));
  scene = morphing_triangle();
  scene.root["bufferViews"][0]["extensions"] = {{"EXT_meshopt_compression", json::object()}};
  EXPECT_THAT(refusal(scene), HasSubstr("a.glb: /bufferViews/0: is compressed"));
  scene = morphing_triangle();
  scene.root["nodes"][0]["extensions"] = {{"EXT_mesh_gpu_instancing", json::object()}};
  EXPECT_THAT(refusal(scene), HasSubstr("a.glb: /nodes/0: shows instances"));
}

TEST_F(CarryGltf, NamesThePlaceOfWhatIsWrong) {
  const std::string whole = morphing_triangle().glb();
  for (std::size_t size = 1; size < whole.size(); ++size)
    EXPECT_THAT(complaint("short.glb", whole.substr(0, size)), HasSubstr("short.glb: byte")) << size;
  const auto replaced = [&](const std::string& pointer, const json& value) {
    GltfScene scene = morphing_triangle();
    scene.root[json::json_pointer(pointer)] = value;
    return complaint("a.glb", scene.glb());
  };
  EXPECT_THAT(replaced("/accessors/0/count", 4),
              HasSubstr("a.glb: /accessors/0: ends behind its buffer view"));
  EXPECT_THAT(replaced("/accessors/0/count", 0), HasSubstr("/accessors/0/count: is zero"));
  EXPECT_THAT(replaced("/accessors/0/count", 1ull << 62), HasSubstr("/accessors/0: ends behind"));
  EXPECT_THAT(replaced("/accessors/0/byteOffset", ~0ull), HasSubstr("/accessors/0: ends behind"));
  EXPECT_THAT(replaced("/accessors/0/bufferView", 99),
              HasSubstr("/accessors/0/bufferView: names element 99 of 5"));
  EXPECT_THAT(replaced("/accessors/0/componentType", 5124),
              HasSubstr("/accessors/0/componentType: is unknown"));
  EXPECT_THAT(replaced("/accessors/0/normalized", 1), HasSubstr("/accessors/0/normalized: is neither"));
  EXPECT_THAT(replaced("/bufferViews/0/byteLength", 1 << 30),
              HasSubstr("/bufferViews/0: ends behind its buffer"));
  EXPECT_THAT(replaced("/nodes/0/mesh", 1), HasSubstr("/nodes/0/mesh: names element 1 of 1"));
  EXPECT_THAT(replaced("/nodes/0/children", {0}), HasSubstr("/nodes/0: is below itself"));
  EXPECT_THAT(replaced("/nodes/0/scale", {1, 0, 1}), HasSubstr("/nodes/0: places its mesh flat"));
  EXPECT_THAT(replaced("/nodes/0/rotation", {1, 0, 1}),
              HasSubstr("/nodes/0/rotation: must be 4 finite numbers"));
  EXPECT_THAT(replaced("/meshes/0/primitives/0/attributes/NORMAL", 2),
              HasSubstr("/meshes/0/primitives/0/attributes/NORMAL: must be VEC3"));
  EXPECT_THAT(replaced("/meshes/0/primitives/0/targets/0/COLOR_0", 77),
              HasSubstr("/targets/0/COLOR_0: names"));
  EXPECT_THAT(replaced("/nodes", json::array()), HasSubstr("a.glb: the file shows no vertices"));
  EXPECT_THAT(complaint("a.gltf", "{\"asset\": }"), HasSubstr("a.gltf: byte 11 of the JSON"));
  EXPECT_THAT(complaint("a.gltf", std::string(100000, '[')), HasSubstr("a.gltf: byte 200 of the JSON"));
  EXPECT_THAT(complaint("a.gltf", R"({"buffers":[{"byteLength":6,"uri":"data:;base64,AAECA/8="}]})"),
              HasSubstr("a.gltf: /buffers/0: has 5 of 6 bytes"));
  EXPECT_THAT(complaint("a.gltf", R"({"buffers":[{"byteLength":6,"uri":"http://a/b"}]})"),
              HasSubstr("a.gltf: /buffers/0/uri: is neither"));
  GltfScene scene = morphing_triangle();
  scene.data.replace(12, 4, bytes(std::nanf("")));
  EXPECT_THAT(complaint("a.glb", scene.glb()), HasSubstr("a.glb: /accessors/0: vector 1 is not finite"));
}

}  // namespace
}  // namespace bespoke
