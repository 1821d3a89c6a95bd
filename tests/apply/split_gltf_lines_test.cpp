#include <gtest/gtest.h>

#include "apply/split_files.h"
#include "bespoke/product/mesh_io.h"
#include "product/gltf_scene.h"

namespace bespoke {
namespace {

using nlohmann::json;
using test::GltfScene;

constexpr int octet_type = 5121, word_type = 5123, float_type = 5126;
constexpr int lines_mode = 1, loop_mode = 2, strip_mode = 3;
// The chord error of an edge along x of length l is l² / 8 under `bend`.
constexpr double length_of_halves = 0.2;  // edges of length 2 are split once

using Octets = std::vector<std::uint8_t>;
using Words = std::vector<std::uint16_t>;
using Floats = std::vector<float>;

class SplitGltfLines : public test::SplitFiles {
 protected:
  /// The vertices (0, 0, 0), (2, 0, 0), (4, 0, 0), (4, 1, 0) with a number each.
  json attributes(GltfScene& scene) {
    return {{"POSITION", scene.accessor(Floats{0, 0, 0, 2, 0, 0, 4, 0, 0, 4, 1, 0}, "VEC3", float_type,
                                        {{"min", {0, 0, 0}}, {"max", {4, 1, 0}}})},
            {"_HEAT", scene.accessor(Floats{0, 2, 4, 6}, "SCALAR", float_type)}};
  }

  test::GlbContent split_primitives(GltfScene& scene, const std::vector<json>& primitives) {
    scene.root["meshes"] = {{{"primitives", primitives}}};
    scene.root["nodes"] = {{{"mesh", 0}}};
    scene.root["scenes"] = {{{"nodes", {0}}}};
    return test::GlbContent(split("a.glb", scene.glb(), length_of_halves));
  }

  Words indices_of(const test::GlbContent& file, std::size_t primitive) {
    const std::size_t accessor = file.root["meshes"][0]["primitives"][primitive]["indices"];
    const json& own = file.root["accessors"][accessor];
    Words numbers;
    const std::size_t size = own["componentType"] == octet_type ? 1 : 2;
    for (std::size_t i = 0; i < own["count"].get<std::size_t>(); ++i) {
      std::uint16_t number = 0;
      std::memcpy(&number, file.data.data() + file.begin(accessor) + i * size, size);
      numbers.push_back(number);
    }
    return numbers;
  }

  /// That the file has the vertices and edges of the refined product.
  void expect_refined() {
    const Product read = read_product(directory_ / "out_a.glb");
    const Product& expected = refined_.product;
    ASSERT_EQ(read.line_edges.size(), expected.line_edges.size());
    EXPECT_EQ(read.vertices.cols(), expected.vertices.cols());
    EXPECT_LT(
        (read.vertices(Eigen::all, read.line_edges) - expected.vertices(Eigen::all, expected.line_edges))
            .cwiseAbs()
            .maxCoeff(),
        1e-6);
  }
};

TEST_F(SplitGltfLines, GivesEveryHalfOfALineItsOwnEnds) {
  GltfScene scene;
  const test::GlbContent file =
      split_primitives(scene, {{{"attributes", attributes(scene)},
                                {"indices", scene.accessor(Octets{0, 1, 2, 3}, "SCALAR", octet_type)},
                                {"mode", lines_mode}}});
  EXPECT_EQ(indices_of(file, 0), (Words{0, 4, 4, 1, 2, 3})) << "the edge along y does not bend";
  EXPECT_EQ(file.root["meshes"][0]["primitives"][0]["mode"], lines_mode);
  const std::size_t heat = file.root["meshes"][0]["primitives"][0]["attributes"]["_HEAT"];
  EXPECT_EQ(file.floats(heat), (Floats{0, 2, 4, 6, 1}));
  expect_refined();
}

TEST_F(SplitGltfLines, KeepsStripsAndLoops) {
  GltfScene scene;
  const json list = attributes(scene);
  const test::GlbContent file =
      split_primitives(scene, {{{"attributes", list}, {"mode", strip_mode}},
                               {{"attributes", list},
                                {"indices", scene.accessor(Words{2, 1, 3}, "SCALAR", word_type)},
                                {"mode", loop_mode}}});
  EXPECT_EQ(indices_of(file, 0), (Words{0, 4, 1, 5, 2, 3}));
  EXPECT_EQ(indices_of(file, 1), (Words{2, 5, 1, 6, 3})) << "one middle for both primitives' edge";
  EXPECT_EQ(file.root["meshes"][0]["primitives"][1]["mode"], loop_mode);
}

TEST_F(SplitGltfLines, LeavesNoGapBesideATriangle) {
  GltfScene scene;
  const test::GlbContent file =
      split_primitives(scene, {{{"attributes", attributes(scene)},
                                {"indices", scene.accessor(Octets{0, 1, 1, 3}, "SCALAR", octet_type)},
                                {"mode", lines_mode}},
                               {{"attributes", attributes(scene)},
                                {"indices", scene.accessor(Octets{0, 1, 3}, "SCALAR", octet_type)}}});
  EXPECT_EQ(indices_of(file, 0), (Words{0, 4, 4, 1, 1, 5, 5, 3}));
  const Product read = read_product(directory_ / "out_a.glb");
  EXPECT_EQ(read.vertices.cols(), refined_.product.vertices.cols()) << "lines and faces share vertices";
  EXPECT_GT(read.polygon_start.size(), 2u);
}

TEST_F(SplitGltfLines, AreNoPartOfAModel) {
  GltfScene scene;
  split_primitives(scene, {{{"attributes", attributes(scene)}, {"mode", strip_mode}},
                           {{"attributes", attributes(scene)},
                            {"indices", scene.accessor(Octets{0, 1, 3}, "SCALAR", octet_type)}}});
  EXPECT_EQ(read_triangle_mesh(directory_ / "a.glb").vertices.cols(), 3);
  EXPECT_EQ(read_product(directory_ / "a.glb").vertices.cols(), 4);
  EXPECT_EQ(read_product(directory_ / "a.glb").line_edges.size(), 6u);
}

}  // namespace
}  // namespace bespoke
