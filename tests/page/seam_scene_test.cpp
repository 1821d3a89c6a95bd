#include "bespoke/page/seam_scene.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "bespoke/error.h"
#include "page/unpacked_scene.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::unpacked;
using test::UnpackedScene;

UnpackedScene scene_of(const TriangleMesh& mesh, const std::string& seams = "") {
  return unpacked(seam_scene({"skirts/skirt.obj", mesh, "", seams, "Seams of skirt", "bespoke pick"}));
}

TEST(SeamScene, HoldsTheGarmentToTheLastBit) {
  const TriangleMesh mesh = test::sphere(Vector3(0.1, 0.2, 0.3), 0.7, 2);
  const UnpackedScene scene = scene_of(mesh);
  EXPECT_EQ(scene.record["page"], "seams");
  EXPECT_EQ(scene.record["garment_path"], "skirts/skirt.obj");
  EXPECT_TRUE(scene.record["seams"].is_null());
  const nlohmann::json& record = scene.record["meshes"].at(0);
  EXPECT_EQ(record["name"], "skirt.obj");
  EXPECT_TRUE(record["original"].is_null());
  const std::vector<std::uint32_t> faces = scene.numbers(record["faces"]);
  ASSERT_EQ(faces.size(), static_cast<std::size_t>(mesh.faces.size()));
  for (std::size_t k = 0; k < faces.size(); ++k)
    EXPECT_EQ(static_cast<int>(faces[k]), mesh.faces.reshaped()[static_cast<Eigen::Index>(k)]);
  const std::vector<std::uint32_t> low = scene.numbers(record["exact"]["low"]),
                                   high = scene.numbers(record["exact"]["high"]);
  const Points transposed = mesh.vertices.transpose().reshaped(3, mesh.vertices.cols());  // all x, y, z
  for (std::size_t k = 0; k < low.size(); ++k)
    EXPECT_EQ(std::bit_cast<double>(std::uint64_t{high[k]} << 32 | low[k]),
              transposed.reshaped()[static_cast<Eigen::Index>(k)]);
}

TEST(SeamScene, BeginsWithTheSeamsOfAFile) {
  const TriangleMesh mesh = test::sphere(Vector3::Zero(), 1, 1);
  const UnpackedScene scene = scene_of(mesh, R"({"seams":[{"path":[1,2]}]})");
  EXPECT_EQ(scene.record["seams"]["seams"][0]["path"], nlohmann::json({1, 2}));
  EXPECT_THROW(scene_of(mesh, "{"), FormatError);
}

TEST(SeamScene, RefusesGarmentsThatAreNone) {
  TriangleMesh mesh = test::sphere(Vector3::Zero(), 1, 1);
  mesh.vertices(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(scene_of(mesh), InvalidInput);
}

}  // namespace
}  // namespace bespoke
