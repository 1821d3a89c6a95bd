#include "bespoke/exchange/glb_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "exchange/turning_product.h"
#include "product/gltf_scene.h"
#include "support/run_program.h"

namespace bespoke {
namespace {

using nlohmann::json;
using test::GlbContent;
using test::half_turn;
using test::IdentityMap;
using test::two_polygons;
using ::testing::HasSubstr;

class GlbFile : public ::testing::Test {
 protected:
  GlbContent written(const MorphingMesh& mesh, const GlbNotes& notes = {"skirt", 0.01}) const {
    write_glb(path_, mesh, notes);
    return GlbContent(test::read_text(path_));
  }
  static MorphingMesh turning(int targets, const Product& product = two_polygons()) {
    return morph_along(product, IdentityMap(), half_turn(), targets);
  }
  static const json& primitive(const GlbContent& file) { return file.root["meshes"][0]["primitives"][0]; }
  static Points points(const GlbContent& file, const json& accessor) {
    const std::vector<float> values = file.floats(accessor);
    return Eigen::Map<const Eigen::Matrix3Xf>(values.data(), 3, Eigen::Index(values.size() / 3))
        .cast<double>();
  }
  /// The places of all triangles' corners: base plus one target.
  static Points corners(const GlbContent& file, int target) {
    Points x = points(file, primitive(file)["attributes"]["POSITION"]);
    if (target > 0) x += points(file, primitive(file)["targets"][std::size_t(target - 1)]["POSITION"]);
    const json& accessor = file.root["accessors"][primitive(file)["indices"].get<std::size_t>()];
    std::vector<std::uint32_t> indices(accessor["count"].get<std::size_t>());
    std::memcpy(indices.data(), file.data.data() + file.begin(primitive(file)["indices"]),
                4 * indices.size());
    return x(Eigen::all, indices);
  }

  test::ScratchDirectory directory_;
  std::filesystem::path path_ = directory_ / "skirt.glb";
};

const std::vector<int> fan = {0, 1, 2, 0, 2, 3, 1, 4, 2};

TEST_F(GlbFile, BaseAndTargetsAreTheMeshAtItsTimes) {
  const MorphingMesh mesh = turning(4);
  const GlbContent file = written(mesh);
  EXPECT_LT((corners(file, 0) - mesh.product.vertices(Eigen::all, fan)).norm(), 1e-6);
  for (int k = 1; k <= 4; ++k)
    EXPECT_LT((corners(file, k) - mesh.targets[std::size_t(k - 1)](Eigen::all, fan)).norm(), 1e-5);
  EXPECT_EQ(file.root["meshes"][0]["extras"]["targetNames"],
            json({"t = 0.25", "t = 0.5", "t = 0.75", "t = 1"}));
}

TEST_F(GlbFile, AnimationGoesThroughTheTargetsOneByOne) {
  const GlbContent file = written(turning(3));
  const json& sampler = file.root["animations"][0]["samplers"][0];
  const std::vector<float> times = file.floats(sampler["input"]), weights = file.floats(sampler["output"]);
  ASSERT_EQ(times.size(), 4u);
  EXPECT_EQ(times.front(), 0);
  EXPECT_NEAR(times[1], 2.0 / 3, 1e-6);
  EXPECT_EQ(weights, (std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}));
}

TEST_F(GlbFile, KeepsTextureCoordinatesByTheCorner) {
  const GlbContent file = written(turning(1));
  const Points x = points(file, primitive(file)["attributes"]["POSITION"]);
  const std::vector<float> uv = file.floats(primitive(file)["attributes"]["TEXCOORD_0"]);
  ASSERT_EQ(x.cols(), 6) << "five vertices in faces, one of them with two texture coordinates";
  std::set<std::pair<float, float>> at_common;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    if (x.col(i) == Vector3(1, 1, 0)) at_common.emplace(uv[2 * std::size_t(i)], uv[2 * std::size_t(i) + 1]);
  // Up in OBJ's images is down in glTF's.
  EXPECT_EQ(at_common, (std::set<std::pair<float, float>>{{0.5f, 0.0f}, {0.75f, 0.0f}}));
}

TEST_F(GlbFile, NormalsTurnWithTheMeshAndAreLeftOutWhereThereWereNone) {
  const GlbContent file = written(turning(2));
  const Points base = points(file, primitive(file)["attributes"]["NORMAL"]);
  for (const json& target : primitive(file)["targets"])
    EXPECT_LT(((base + points(file, target["NORMAL"])).colwise().norm().array() - 1).abs().maxCoeff(), 1e-6);
  // Half a turn about y turns z round.
  EXPECT_LT((points(file, primitive(file)["targets"][1]["NORMAL"]) + 2 * base).norm(), 1e-5);
  Product bare = two_polygons();
  bare.has_normals = false;
  EXPECT_FALSE(primitive(written(turning(2, bare)))["attributes"].contains("NORMAL"));
}

TEST_F(GlbFile, IsInMetresWhereTheUnitIsKnown) {
  EXPECT_EQ(written(turning(1)).root["nodes"][0]["scale"], json({0.01, 0.01, 0.01}));
  EXPECT_FALSE(written(turning(1), {"skirt", {}}).root["nodes"][0].contains("scale"));
}

TEST_F(GlbFile, SameMeshGivesTheSameBytes) {
  written(turning(2));
  const std::string first = test::read_text(path_);
  written(turning(2));
  EXPECT_EQ(test::read_text(path_), first);
}

TEST_F(GlbFile, IsValidToKhronos) {
  if (test::run_program({"node", BESPOKE_GLTF_VALIDATOR}).exit_code != 0)
    GTEST_SKIP() << "gltf-validator is not installed: install nodejs and npm, then run tools/setup";
  Product plain = two_polygons();
  plain.has_normals = false;
  plain.texture.resize(2, 0);
  Product flat = two_polygons();
  flat.vertices.col(4) = flat.vertices.col(1);  // a face without area, and so without a normal
  for (const Product& product : {two_polygons(), plain, flat}) {
    written(turning(3, product));
    EXPECT_THAT(test::run_program({"node", BESPOKE_GLTF_VALIDATOR, path_}).out,
                HasSubstr("0 errors, 0 warnings"));
  }
}

}  // namespace
}  // namespace bespoke
