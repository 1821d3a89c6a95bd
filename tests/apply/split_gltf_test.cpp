#include <gmock/gmock.h>

#include <array>
#include <cstring>
#include <random>

#include "apply/split_files.h"
#include "bespoke/product/gltf/document/gltf_file.h"
#include "product/gltf_scene.h"
#include "support/run_program.h"

namespace bespoke {
namespace {

using nlohmann::json;
using test::GlbContent;
using test::GltfScene;
using ::testing::ElementsAre;
using ::testing::FloatNear;
using ::testing::HasSubstr;
using ::testing::Pointwise;

constexpr int int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, real = 5126;
constexpr double unsplit_error = 9,
                 split_error = 1.1;  // chord errors without a split of four units, and with one

using Octets = std::vector<std::uint8_t>;
using Words = std::vector<std::uint16_t>;
using Floats = std::vector<float>;

class SplitGltf : public test::SplitFiles {
 protected:
  GlbContent split_scene(GltfScene& scene, double length = split_error) {
    return GlbContent(split("a.glb", scene.glb(), length));
  }

  /// That what is split has the corners of the refined product.
  void expect_refined(const std::string& name) const {
    const Product read = read_product(directory_ / name);
    const Product& expected = refined_.product;
    ASSERT_EQ(read.polygon_start, expected.polygon_start);
    EXPECT_LT((read.vertices(Eigen::all, read.corners) - expected.vertices(Eigen::all, expected.corners))
                  .cwiseAbs()
                  .maxCoeff(),
              2e-6);
    EXPECT_EQ(read.vertices.cols(), expected.vertices.cols()) << "edges that faces share stay shared";
  }
};

/// A scene of one node that shows one mesh.
GltfScene scene_of(GltfScene scene, const std::vector<json>& primitives) {
  scene.root["meshes"] = {{{"primitives", primitives}}};
  scene.root["nodes"] = {{{"mesh", 0}}};
  scene.root["scenes"] = {{{"nodes", {0}}}};
  return scene;
}

/// A triangle whose edges along x are split, the longest first: vertex 4 is between 0 and 1, vertex 3 between
/// 0 and 2.
int positions_of_triangle(GltfScene& scene) {
  return scene.accessor(Floats{0, 0, 0, 4, 0, 0, 4, 1, 0}, "VEC3", real,
                        {{"min", {0, 0, 0}}, {"max", {4, 1, 0}}});
}

template <class Value>
std::vector<Value> vector_at(const GlbContent& file, std::size_t accessor, std::size_t index,
                             std::size_t components) {
  const json& view =
      file.root["bufferViews"][file.root["accessors"][accessor]["bufferView"].get<std::size_t>()];
  const std::size_t stride = view.value("byteStride", components * sizeof(Value));
  std::vector<Value> values(components);
  std::memcpy(values.data(), file.data.data() + file.begin(accessor) + index * stride,
              components * sizeof(Value));
  return values;
}

json primitive_of(const GlbContent& file, std::size_t primitive = 0, std::size_t mesh = 0) {
  return file.root["meshes"][mesh]["primitives"][primitive];
}

/// The values of an attribute at the middle of the triangle's lower edge along x, and of its longest edge.
template <class Value>
std::array<std::vector<Value>, 2> middles(const GlbContent& file, const json& list, const char* name,
                                          std::size_t components) {
  const std::size_t accessor = list[name];
  return {vector_at<Value>(file, accessor, 4, components), vector_at<Value>(file, accessor, 3, components)};
}

template <class Value>
std::vector<Value> indices_of(const GlbContent& file, const json& primitive) {
  const std::size_t accessor = primitive["indices"];
  return vector_at<Value>(file, accessor, 0, file.root["accessors"][accessor]["count"]);
}

auto near(const Floats& expected) { return Pointwise(FloatNear(1e-6F), expected); }

TEST_F(SplitGltf, GivesMiddlesMeansOfTheirEnds) {
  GltfScene scene;
  json attributes{{"POSITION", positions_of_triangle(scene)}};
  attributes["NORMAL"] = scene.accessor(Floats{0, 0, 1, 0, 1, 0, 0, 0, -1}, "VEC3", real);
  attributes["TANGENT"] = scene.accessor(Floats{1, 0, 0, -1, 0, 0, 1, -1, 1, 0, 0, -1}, "VEC4", real);
  attributes["TEXCOORD_0"] = scene.accessor(Floats{0, 0, 1, 0, 1, 1}, "VEC2", real);
  attributes["TEXCOORD_1"] = scene.accessor(Words{0, 65535, 10, 65535, 65535, 0}, "VEC2", uint16,
                                            {{"normalized", true}, {"name", "second"}});
  attributes["COLOR_0"] =
      scene.accessor(Octets{0, 10, 255, 20, 20, 0, 101, 0, 1}, "VEC3", uint8, {{"normalized", true}});
  attributes["_HEAT"] = scene.accessor(Floats{1, 3, 7}, "SCALAR", real);
  attributes["_PANEL"] = scene.accessor(Words{7, 9, 11}, "SCALAR", uint16);
  scene = scene_of(scene, {{{"attributes", attributes}}});
  const GlbContent file = split_scene(scene);
  const json list = primitive_of(file)["attributes"];
  const auto floats = [&](const char* name, std::size_t components) {
    return middles<float>(file, list, name, components);
  };
  EXPECT_EQ(floats("POSITION", 3)[0], (Floats{2, 0, 0}));
  EXPECT_EQ(floats("POSITION", 3)[1], (Floats{2, 0.5, 0}));
  const float half = std::sqrt(0.5F);
  EXPECT_THAT(floats("NORMAL", 3)[0], near({0, half, half}));
  EXPECT_THAT(floats("NORMAL", 3)[1], near({0, 0, 1})) << "opposite ones have no mean";
  EXPECT_THAT(floats("TANGENT", 4)[0], near({half, 0, half, -1}));
  EXPECT_EQ(floats("TEXCOORD_0", 2)[1], (Floats{0.5, 0.5}));
  EXPECT_EQ(middles<std::uint16_t>(file, list, "TEXCOORD_1", 2)[0], (Words{5, 65535}));
  EXPECT_EQ(middles<std::uint8_t>(file, list, "COLOR_0", 3)[0], (Octets{10, 15, 128}));
  EXPECT_EQ(floats("_HEAT", 1)[1], Floats{4});
  EXPECT_EQ(middles<std::uint16_t>(file, list, "_PANEL", 1)[0], Words{7}) << "a name has no mean";
  EXPECT_EQ(file.root["accessors"][list["TEXCOORD_1"].get<std::size_t>()]["name"], "second");
  EXPECT_EQ(file.root["accessors"][list["POSITION"].get<std::size_t>()]["max"], json({4, 1, 0}));
  EXPECT_EQ(indices_of<std::uint16_t>(file, primitive_of(file)), (Words{3, 0, 4, 3, 4, 1, 2, 3, 1}));
}

TEST_F(SplitGltf, MergesTheJointsOfBothEnds) {
  GltfScene scene;
  json attributes{{"POSITION", positions_of_triangle(scene)}};
  attributes["JOINTS_0"] = scene.accessor(Octets{1, 2, 3, 0, 2, 4, 5, 6, 9, 0, 0, 0}, "VEC4", uint8);
  attributes["WEIGHTS_0"] =
      scene.accessor(Floats{0.5, 0.25, 0.25, 0, 0.5, 0.25, 0.125, 0.125, 1, 0, 0, 0}, "VEC4", real);
  scene = scene_of(scene, {{{"attributes", attributes}}});
  const GlbContent file = split_scene(scene);
  const json list = primitive_of(file)["attributes"];
  // 2: 3/8, 1: 1/4, 3 and 4: 1/8, which are 7/8 together; 5 and 6 find no space.
  EXPECT_EQ(middles<std::uint8_t>(file, list, "JOINTS_0", 4)[0], (Octets{2, 1, 3, 4}));
  EXPECT_THAT(middles<float>(file, list, "WEIGHTS_0", 4)[0], near({3 / 7.F, 2 / 7.F, 1 / 7.F, 1 / 7.F}));
  EXPECT_EQ(middles<std::uint8_t>(file, list, "JOINTS_0", 4)[1], (Octets{9, 1, 2, 3}));
}

TEST_F(SplitGltf, KeepsTheSumOfWholeWeightsAndUsesEverySet) {
  GltfScene scene;
  json attributes{{"POSITION", positions_of_triangle(scene)}};
  attributes["JOINTS_0"] = scene.accessor(Words{1, 2, 3, 4, 5, 6, 7, 8, 1, 0, 0, 0}, "VEC4", uint16);
  attributes["JOINTS_1"] = scene.accessor(Words{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4", uint16);
  const json normalized{{"normalized", true}};
  attributes["WEIGHTS_0"] =
      scene.accessor(Octets{64, 64, 64, 63, 65, 65, 64, 61, 255, 0, 0, 0}, "VEC4", uint8, normalized);
  attributes["WEIGHTS_1"] = scene.accessor(Octets(12, 0), "VEC4", uint8, normalized);
  scene = scene_of(scene, {{{"attributes", attributes}}});
  const GlbContent file = split_scene(scene, 0.1);
  const json list = primitive_of(file)["attributes"];
  const std::size_t weights = list["WEIGHTS_0"], more = list["WEIGHTS_1"];
  const std::size_t count = file.root["accessors"][weights]["count"];
  ASSERT_GT(count, 5u);
  for (std::size_t vertex = 0; vertex < count; ++vertex) {
    int sum = 0;
    for (const std::size_t accessor : {weights, more})
      for (const std::uint8_t weight : vector_at<std::uint8_t>(file, accessor, vertex, 4)) sum += weight;
    EXPECT_EQ(sum, 255) << vertex;
  }
  constexpr std::size_t middle = 4;  // of vertices 0 and 1
  std::vector<std::uint16_t> joints = vector_at<std::uint16_t>(file, list["JOINTS_0"], middle, 4);
  const std::vector<std::uint16_t> others = vector_at<std::uint16_t>(file, list["JOINTS_1"], middle, 4);
  joints.insert(joints.end(), others.begin(), others.end());
  EXPECT_THAT(joints, ::testing::UnorderedElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
}

// The middle of a morphed edge is where the morphed middle is, and its normal has the morphed normals' mean.
TEST_F(SplitGltf, MorphsMiddlesAsTheirEnds) {
  GltfScene scene;
  json attributes{{"POSITION", positions_of_triangle(scene)}};
  attributes["NORMAL"] = scene.accessor(Floats{0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", real);
  const int index = scene.accessor(Words{1}, "SCALAR", uint16);
  const int value = scene.accessor(Floats{0, 0, 6}, "VEC3", real);
  scene.root["accessors"].push_back({{"componentType", real},
                                     {"count", 3},
                                     {"type", "VEC3"},
                                     {"sparse",
                                      {{"count", 1},
                                       {"indices", {{"bufferView", index}, {"componentType", uint16}}},
                                       {"values", {{"bufferView", value}}}}}});
  const std::size_t sparse = scene.root["accessors"].size() - 1;
  const int turned = scene.accessor(Floats{0, 0, 0, 0, 1, -1, 0, 0, 0}, "VEC3", real);
  const int small = scene.accessor(std::vector<std::int8_t>{0, 0, 0, 1, 0, 0, 0, 0, 0}, "VEC3", int8);
  scene =
      scene_of(scene, {{{"attributes", attributes},
                        {"targets", {{{"POSITION", sparse}, {"NORMAL", turned}}, {{"POSITION", small}}}}}});
  const GlbContent file = split_scene(scene);
  const json targets = primitive_of(file)["targets"];
  EXPECT_EQ(middles<float>(file, targets[0], "POSITION", 3)[0], (Floats{0, 0, 3}));
  EXPECT_EQ(middles<float>(file, targets[0], "POSITION", 3)[1], (Floats{0, 0, 0}));
  const float half = std::sqrt(0.5F);
  EXPECT_THAT(middles<float>(file, targets[0], "NORMAL", 3)[0], near({0, half, half - 1}));
  EXPECT_EQ(middles<float>(file, targets[0], "NORMAL", 3)[1], (Floats{0, 0, 0})) << "to the last bit";
  EXPECT_EQ(middles<float>(file, targets[1], "POSITION", 3)[0], (Floats{0.5, 0, 0}));
  EXPECT_FALSE(file.root["accessors"][targets[0]["POSITION"].get<std::size_t>()].contains("sparse"));
}

// Accessors and views that nothing else uses have the new values; no others are there, and no other bytes.
TEST_F(SplitGltf, KeepsAllElse) {
  GltfScene scene = test::morphing_triangle();
  scene.root["nodes"][0]["scale"] = {4, 1, 1};
  scene.root["materials"] = {{{"name", "cloth"}}};
  scene.root["meshes"][0]["primitives"][0].update({{"material", 0}, {"extras", {{"price", 1}}}});
  scene.root["meshes"][0]["weights"] = {0.5};
  const int times = scene.accessor(Floats{0, 1}, "SCALAR", real);
  const int places = scene.accessor(Floats{0, 0, 0, 1, 2, 3}, "VEC3", real);
  scene.root["animations"] = {
      {{"samplers", {{{"input", times}, {"output", places}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  const std::string content = scene.glb();
  const GlbContent before(content);
  const GlbContent after(split("a.glb", content, split_error));
  ASSERT_GT(refined_.splits.vertices.size(), 0u);
  std::size_t bytes = 0;
  for (const json& view : after.root["bufferViews"]) bytes += view["byteLength"].get<std::size_t>() + 3;
  EXPECT_LE(after.data.size(), bytes);
  for (const int accessor : {times, places}) {
    const auto index = static_cast<std::size_t>(accessor);
    EXPECT_EQ(after.floats(index), before.floats(index));
    EXPECT_EQ(after.root["accessors"][index], before.root["accessors"][index]);
  }
  json kept = after.root;
  for (const char* array : {"accessors", "bufferViews", "buffers"}) {
    EXPECT_EQ(kept[array].size(), before.root[array].size()) << array;
    kept[array] = before.root[array];
  }
  EXPECT_EQ(kept, before.root);
}

// Of a view that attributes share nothing is left once all of them are split.
TEST_F(SplitGltf, TakesInterleavedAttributesApart) {
  GltfScene scene;
  const int positions = scene.accessor(Floats{0, 0, 0, 0, 0, 1, 4, 0, 0, 0, 0, 1, 4, 1, 0, 0, 0, 1}, "VEC3",
                                       real, {{"count", 3}});
  scene.root["bufferViews"][0]["byteStride"] = 24;
  scene.root["accessors"].push_back(scene.root["accessors"][0]);
  scene.root["accessors"][1]["byteOffset"] = 12;
  scene = scene_of(scene, {{{"attributes", {{"POSITION", positions}, {"NORMAL", positions + 1}}}}});
  const GlbContent file = split_scene(scene);
  EXPECT_EQ(primitive_of(file)["attributes"], scene.root["meshes"][0]["primitives"][0]["attributes"]);
  EXPECT_EQ(middles<float>(file, primitive_of(file)["attributes"], "POSITION", 3)[0], (Floats{2, 0, 0}));
  EXPECT_EQ(middles<float>(file, primitive_of(file)["attributes"], "NORMAL", 3)[1], (Floats{0, 0, 1}));
  EXPECT_EQ(file.data.size(), 2 * 5 * 12 + 20u) << "five vertices and nine indices";
  EXPECT_EQ(file.root["bufferViews"].size(), 3u);
}

// A mesh that no node shows is not split, and what it shares stays.
TEST_F(SplitGltf, KeepsWhatOthersUse) {
  GltfScene scene;
  const json attributes{{"POSITION", positions_of_triangle(scene)}};
  const int indices = scene.accessor(Words{0, 1, 2}, "SCALAR", uint16);
  scene = scene_of(scene, {{{"attributes", attributes}, {"indices", indices}}});
  scene.root["meshes"].push_back({{"primitives", {{{"attributes", attributes}}}}});
  const GlbContent before(scene.glb());
  const GlbContent after = split_scene(scene);
  EXPECT_EQ(after.root["meshes"][1], before.root["meshes"][1]);
  EXPECT_EQ(after.root["accessors"][0], before.root["accessors"][0]);
  EXPECT_EQ(after.floats(0), before.floats(0));
  EXPECT_NE(primitive_of(after)["attributes"], attributes);
  EXPECT_EQ(primitive_of(after)["indices"], indices);
}

TEST_F(SplitGltf, KeepsCharacters) {
  GltfScene scene;
  const json attributes{{"POSITION", positions_of_triangle(scene)}};
  scene = scene_of(scene, {{{"attributes", attributes}}});
  std::string text = scene.gltf(data_uri_of("data:application/octet-stream;base64,", scene.data));
  const std::string marked = "\"attributes\"", odd = "\"extras\" : {\"price\":1.50e0 , \"size\": 2.0},\t";
  text.insert(text.find(marked), odd);
  text.insert(text.find("\"asset\""), odd);
  const std::string out = split("a.gltf", text, split_error);
  EXPECT_THAT(out, HasSubstr(odd + "\"asset\""));
  EXPECT_THAT(out, HasSubstr(odd + marked));
  EXPECT_THAT(out, HasSubstr("\"indices\":"));
  expect_refined("out_a.gltf");
}

TEST_F(SplitGltf, LeavesAFileThatStaysStraight) {
  GltfScene scene = test::morphing_triangle();
  const std::string content = scene.glb();
  EXPECT_EQ(split("a.glb", content, unsplit_error), content);
}

// Vertices that two primitives share are split once; points stay, and so do triangles that no split meets.
TEST_F(SplitGltf, SplitsSharedVerticesOnce) {
  GltfScene scene;
  const json attributes{
      {"POSITION", scene.accessor(Floats{0, 0, 0, 4, 0, 0, 4, 1, 0, 4, -1, 0, 4, 0, 1}, "VEC3", real)}};
  const int first = scene.accessor(Octets{0, 1, 2}, "SCALAR", uint8);
  const int second = scene.accessor(std::vector<std::uint32_t>{1, 0, 3}, "SCALAR", uint32);
  const int third = scene.accessor(Words{1, 2, 4}, "SCALAR", uint16);
  scene = scene_of(scene, {{{"attributes", attributes}, {"indices", first}},
                           {{"attributes", attributes}, {"mode", 0}},
                           {{"attributes", attributes}, {"indices", second}},
                           {{"attributes", attributes}, {"indices", third}}});
  const GlbContent file = split_scene(scene);
  EXPECT_EQ(primitive_of(file, 0)["attributes"], primitive_of(file, 2)["attributes"]);
  EXPECT_NE(primitive_of(file, 0)["attributes"]["POSITION"], attributes["POSITION"]);
  const std::size_t accessor = primitive_of(file, 0)["attributes"]["POSITION"];
  EXPECT_EQ(file.root["accessors"][accessor]["count"], 8) << "three edges";
  for (const std::size_t stays : {1, 3})
    EXPECT_EQ(primitive_of(file, stays), scene.root["meshes"][0]["primitives"][stays]);
  const auto type = [&](std::size_t p) {
    return file.root["accessors"][primitive_of(file, p)["indices"].get<std::size_t>()]["componentType"];
  };
  EXPECT_EQ(type(0), uint8);
  EXPECT_EQ(type(2), uint32);
  expect_refined("out_a.glb");
}

TEST_F(SplitGltf, WidensIndicesThatDoNotFit) {
  for (const auto& [vertices, before, after] :
       {std::array{253, uint8, uint8}, {254, uint8, uint16}, {65534, uint16, uint32}}) {
    GltfScene scene;
    Floats positions(static_cast<std::size_t>(3 * vertices), 0);
    positions[3] = positions[6] = 4;
    positions[7] = 1;
    const json attributes{{"POSITION", scene.accessor(positions, "VEC3", real)}};
    const int indices = before == uint8 ? scene.accessor(Octets{0, 1, 2}, "SCALAR", uint8)
                                        : scene.accessor(Words{0, 1, 2}, "SCALAR", uint16);
    scene = scene_of(scene, {{{"attributes", attributes}, {"indices", indices}}});
    const GlbContent file = split_scene(scene);
    const std::size_t accessor = primitive_of(file)["indices"];
    EXPECT_EQ(file.root["accessors"][accessor]["componentType"], after) << vertices;
    expect_refined("out_a.glb");
  }
}

/// Nodes that show the triangle.
GltfScene shown_by(const json& nodes) {
  GltfScene scene;
  scene = scene_of(scene, {{{"attributes", {{"POSITION", positions_of_triangle(scene)}}}}});
  scene.root["nodes"] = nodes;
  scene.root["scenes"][0]["nodes"] = json::array();
  for (std::size_t i = 0; i < nodes.size(); ++i) scene.root["scenes"][0]["nodes"].push_back(i);
  return scene;
}

TEST_F(SplitGltf, SplitsAMeshWhereverItIsShown) {
  // A quarter turn about z lays the long edges across the bend.
  const json across{{"mesh", 0}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}};
  GltfScene scene = shown_by({{{"mesh", 0}}, across, {{"mesh", 0}, {"translation", {0, 9, 0}}}});
  const GlbContent file = split_scene(scene);
  EXPECT_EQ(file.root["nodes"][0]["mesh"], 0);
  EXPECT_EQ(file.root["nodes"][1]["mesh"], 1);
  EXPECT_EQ(file.root["nodes"][2]["mesh"], 0) << "split as at the first place";
  EXPECT_EQ(file.root["meshes"].size(), 2u);
  EXPECT_EQ(file.root["meshes"][1], scene.root["meshes"][0]);
  expect_refined("out_a.glb");
}

TEST_F(SplitGltf, KeepsTheFrontOfMirroredMeshes) {
  GltfScene scene = shown_by({{{"mesh", 0}, {"scale", {-1, 1, 1}}}});
  const GlbContent file = split_scene(scene);
  const Words indices = indices_of<std::uint16_t>(file, primitive_of(file));
  const std::size_t positions = primitive_of(file)["attributes"]["POSITION"];
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    std::array<Vector3, 3> x;
    for (std::size_t k = 0; k < 3; ++k) {
      const Floats place = vector_at<float>(file, positions, indices[i + k], 3);
      x[k] = Vector3(place[0], place[1], place[2]);
    }
    EXPECT_GT((x[1] - x[0]).cross(x[2] - x[0]).z(), 0) << i;
  }
  expect_refined("out_a.glb");
}

TEST_F(SplitGltf, TurnsStripsAndFansIntoLists) {
  for (const int mode : {5, 6}) {
    GltfScene scene;
    const int positions = scene.accessor(Floats{0, 0, 0, 4, 0, 0, 4, 1, 0, 0, 2, 1, -4, 1, 0}, "VEC3", real);
    scene = scene_of(scene, {{{"attributes", {{"POSITION", positions}}}, {"mode", mode}}});
    const GlbContent file = split_scene(scene);
    EXPECT_EQ(primitive_of(file)["mode"], 4);
    expect_refined("out_a.glb");
  }
}

// Whole positions have no whole middles.
TEST_F(SplitGltf, GivesQuantisedPositionsFloats) {
  GltfScene scene;
  const int positions =
      scene.accessor(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 32767, 16384, 0}, "VEC3", int16,
                     {{"normalized", true}, {"min", {0, 0, 0}}, {"max", {32767, 16384, 0}}});
  scene = scene_of(scene, {{{"attributes", {{"POSITION", positions}}}}});
  scene.root["nodes"][0]["scale"] = {4, 4, 4};
  const GlbContent file = split_scene(scene);
  const json& now = file.root["accessors"][primitive_of(file)["attributes"]["POSITION"].get<std::size_t>()];
  EXPECT_EQ(now["componentType"], real);
  EXPECT_FALSE(now.contains("normalized"));
  EXPECT_EQ(now["max"][0], 1);
  expect_refined("out_a.glb");
}

TEST_F(SplitGltf, PutsWhatIsNewBesideBuffersOfTheirOwn) {
  GltfScene scene;
  scene = scene_of(scene, {{{"attributes", {{"POSITION", positions_of_triangle(scene)}}}}});
  file("a.bin", scene.data);
  const json out = json::parse(split("a.gltf", scene.gltf("a.bin"), split_error));
  ASSERT_EQ(out["buffers"].size(), 2u);
  EXPECT_EQ(out["buffers"][0]["byteLength"], scene.data.size());
  EXPECT_THAT(out["buffers"][1]["uri"].get<std::string>(), ::testing::StartsWith("data:"));
  EXPECT_EQ(test::read_text(directory_ / out["buffers"][0]["uri"].get<std::string>()), scene.data);
  expect_refined("out_a.gltf");
}

TEST_F(SplitGltf, RefusesWhatItCannotSplit) {
  GltfScene scene;
  json attributes{{"POSITION", positions_of_triangle(scene)}};
  attributes["TEXCOORD_0"] = scene.accessor(Floats{0, 0, 1, 0}, "VEC2", real);
  scene = scene_of(scene, {{{"attributes", attributes}}});
  EXPECT_THAT(
      test::error_message<FormatError>([&] { split_scene(scene); }),
      HasSubstr("/meshes/0/primitives/0/attributes/TEXCOORD_0: has 2 values, but there are 3 positions"));
  scene.root["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
  split_scene(scene);
  const std::string other = file("b.glb", shown_by({{{"mesh", 0}}, {{"mesh", 0}}}).glb());
  EXPECT_THAT(
      test::error_message<InvalidInput>([&] {
        carry_product(other, {directory_ / "c.glb"}, test::identity_motion(), {{}, {}, &refined_.splits});
      }),
      HasSubstr("b.glb: it has other faces"));
  scene.root["meshes"][0]["primitives"][0]["extensions"] = {{"KHR_draco_mesh_compression", json::object()}};
  EXPECT_THAT(test::error_message<InvalidInput>([&] { split_scene(scene); }), HasSubstr("is compressed"));
  scene.root["accessors"][0].erase("bufferView");
  EXPECT_THAT(test::error_message<InvalidInput>([&] { split_scene(scene); }), HasSubstr("is compressed"));
}

/// Meshes of a random cloud, of every mode and type of index, shown here and there.
GltfScene random_scene(std::mt19937& random) {
  std::uniform_real_distribution<float> coordinate(-2, 2);
  const auto number = [&](int most) { return std::uniform_int_distribution<int>(0, most)(random); };
  GltfScene scene;
  for (int mesh = 0; mesh < 2; ++mesh) {
    json primitives;
    for (int p = 0; p < 3; ++p) {
      Floats x(27);
      for (float& value : x) value = coordinate(random);
      json primitive{{"attributes", {{"POSITION", scene.accessor(x, "VEC3", real)}}}, {"mode", 4 + p}};
      Words corners;
      for (int k = 0; k < 12; ++k) corners.push_back(static_cast<std::uint16_t>(number(8)));
      if (number(2) > 0) primitive["indices"] = scene.accessor(corners, "SCALAR", uint16);
      primitives.push_back(primitive);
    }
    scene.root["meshes"].push_back({{"primitives", primitives}});
  }
  for (int node = 0; node < 4; ++node) {
    scene.root["nodes"].push_back({{"mesh", node % 2},
                                   {"rotation", {0, number(1), 0, 1}},
                                   {"scale", {number(1) == 0 ? -1 : 2, 1, 1}},
                                   {"translation", {0, 3 * number(1), 0.5}}});
    scene.root["nodes"][node]["rotation"][3] = scene.root["nodes"][node]["rotation"][1] == 1 ? 0 : 1;
  }
  scene.root["scenes"] = {{{"nodes", {0, 1, 2, 3}}}};
  return scene;
}

TEST_F(SplitGltf, IsTheRefinedProduct) {
  std::mt19937 random(5);
  for (int round = 0; round < 30; ++round) {
    GltfScene scene = random_scene(random);
    split_scene(scene, 0.05);
    expect_refined("out_a.glb");
  }
}

/// A triangle with a skin, a morph target and two sets of texture coordinates.
GltfScene dressed_triangle() {
  GltfScene scene;
  const json normalized{{"normalized", true}};
  json attributes{{"POSITION", positions_of_triangle(scene)}};
  attributes["NORMAL"] =
      scene.accessor(std::vector<std::int8_t>{0, 0, 127, 0, 127, 0, 0, 0, 127}, "VEC3", int8, normalized);
  attributes["TANGENT"] = scene.accessor(Floats{1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4", real);
  attributes["TEXCOORD_0"] = scene.accessor(Floats{0, 0, 1, 0, 1, 1}, "VEC2", real);
  attributes["TEXCOORD_1"] = scene.accessor(Octets{0, 255, 10, 20, 30, 40}, "VEC2", uint8, normalized);
  attributes["COLOR_0"] =
      scene.accessor(Octets{0, 0, 255, 255, 0, 0, 0, 9, 0, 0, 0, 7}, "VEC4", uint8, normalized);
  attributes["JOINTS_0"] = scene.accessor(Octets{0, 1, 2, 3, 1, 2, 3, 4, 4, 0, 0, 0}, "VEC4", uint8);
  attributes["WEIGHTS_0"] =
      scene.accessor(Octets{100, 100, 50, 5, 85, 85, 84, 1, 255, 0, 0, 0}, "VEC4", uint8, normalized);
  const int target = scene.accessor(Floats{0, 0, 0, 0, 0, 1, 0, 0, 0}, "VEC3", real,
                                    {{"min", {0, 0, 0}}, {"max", {0, 0, 1}}});
  const int turned = scene.accessor(Floats{0, 0, 0, 0, -1, 1, 0, 0, 0}, "VEC3", real);
  for (json& view : scene.root["bufferViews"]) view["target"] = 34962;
  const int indices = scene.accessor(Words{0, 1, 2}, "SCALAR", uint16);
  scene.root["bufferViews"].back()["target"] = 34963;
  scene = scene_of(scene, {{{"attributes", attributes},
                            {"indices", indices},
                            {"targets", {{{"POSITION", target}, {"NORMAL", turned}}}}}});
  Floats binds;
  for (int joint = 0; joint < 5; ++joint)
    for (int k = 0; k < 16; ++k) binds.push_back(k % 5 == 0 ? 1 : 0);
  scene.root["skins"] = {
      {{"joints", {1, 2, 3, 4, 5}}, {"inverseBindMatrices", scene.accessor(binds, "MAT4", real)}}};
  scene.root["nodes"][0]["skin"] = 0;
  for (int joint = 0; joint < 5; ++joint) scene.root["nodes"].push_back({{"name", "joint"}});
  scene.root["scenes"][0]["nodes"] = {0, 1, 2, 3, 4, 5};
  scene.root["extensionsUsed"] = scene.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  return scene;
}

TEST_F(SplitGltf, IsValidToKhronos) {
  if (test::run_program({"node", BESPOKE_GLTF_VALIDATOR}).exit_code != 0)
    GTEST_SKIP() << "gltf-validator is not installed: install nodejs and npm, then run tools/setup";
  const auto expect_valid = [&](const std::string& name, const std::string& content) {
    split(name, content, 0.02);
    ASSERT_GT(refined_.splits.vertices.size(), 9u);
    const std::filesystem::path bent = directory_ / ("bent_" + name);
    carry_product(directory_ / name, {bent}, test::bend_motion(), {{}, {}, &refined_.splits});
    for (const std::filesystem::path& path : {directory_ / name, directory_ / ("out_" + name), bent})
      EXPECT_THAT(test::run_program({"node", BESPOKE_GLTF_VALIDATOR, path.string()}).out,
                  HasSubstr("0 errors, 0 warnings"))
          << path;
  };
  GltfScene scene = dressed_triangle();
  expect_valid("a.glb", scene.glb());
  expect_valid("b.gltf", scene.gltf(data_uri_of("data:application/gltf-buffer;base64,", scene.data)));
  file("c.bin", scene.data);
  expect_valid("c.gltf", scene.gltf("c.bin"));
  GltfScene twice = shown_by({{{"mesh", 0}}, {{"mesh", 0}, {"rotation", {0, 0, 0.6, 0.8}}}});
  expect_valid("d.glb", twice.glb());
}

}  // namespace
}  // namespace bespoke
