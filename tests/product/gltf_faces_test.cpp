#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/product/product_io.h"
#include "product/gltf_scene.h"
#include "product/mesh_files.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::json;
using GltfFaces = test::MeshFiles;
using test::GltfScene;

/// Two triangles of a unit square that share no vertex, as along a seam of the texture.
GltfScene seamed_square() {
  GltfScene scene;
  const int positions =
      scene.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3", 5126,
                     {{"min", {0, 0, 0}}, {"max", {1, 1, 0}}});
  scene.root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}}}}}};
  scene.root["nodes"] = {{{"mesh", 0}}};
  scene.root["scenes"] = {{{"nodes", {0}}}};
  return scene;
}

TEST_F(GltfFaces, AreJoinedAcrossSeams) {
  const Product product = read_product(file("a.glb", seamed_square().glb()));
  EXPECT_EQ(product.vertices, (Points{{0, 1, 1, 0}, {0, 0, 1, 1}, {0, 0, 0, 0}}));
  EXPECT_THAT(product.corners, ElementsAre(0, 1, 2, 0, 2, 3));
}

TEST_F(GltfFaces, LieWhereNodesShowThem) {
  GltfScene scene = seamed_square();
  scene.root["nodes"] = {{{"mesh", 0}, {"translation", {10, 0, 0}}},
                         {{"mesh", 0}, {"scale", {-2, 1, 1}}}};  // mirrored: its faces are flipped
  scene.root["scenes"] = {{{"nodes", {0, 1}}}};
  const Product product = read_product(file("a.glb", scene.glb()));
  EXPECT_EQ(product.vertices,
            (Points{{10, 11, 11, 10, 0, -2, -2, 0}, {0, 0, 1, 1, 0, 1, 0, 1}, {0, 0, 0, 0, 0, 0, 0, 0}}));
  EXPECT_THAT(product.corners, ElementsAre(0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 7, 5));
}

TEST_F(GltfFaces, AreReadFromEveryKindOfPrimitive) {
  for (const int component : {5121, 5123, 5125})
    for (const int mode : {5, 6}) {
      GltfScene scene = seamed_square();
      const int indices =
          component == 5121   ? scene.accessor(std::vector<std::uint8_t>{0, 1, 2, 5}, "SCALAR", component)
          : component == 5123 ? scene.accessor(std::vector<std::uint16_t>{0, 1, 2, 5}, "SCALAR", component)
                              : scene.accessor(std::vector<std::uint32_t>{0, 1, 2, 5}, "SCALAR", component);
      Json& primitive = scene.root["meshes"][0]["primitives"][0];
      primitive["indices"] = indices;
      primitive["mode"] = mode;
      const Product product = read_product(file("a.glb", scene.glb()));
      if (mode == 6)
        EXPECT_THAT(product.corners, ElementsAre(0, 1, 2, 0, 2, 3));
      else
        EXPECT_THAT(product.corners, ElementsAre(0, 1, 2, 2, 1, 3));
    }
}

TEST_F(GltfFaces, NameThePlaceOfWhatIsWrong) {
  GltfScene scene = seamed_square();
  scene.root["meshes"][0]["primitives"][0]["indices"] =
      scene.accessor(std::vector<std::uint8_t>{0, 1, 6}, "SCALAR", 5121);
  EXPECT_THAT(complaint("a.glb", scene.glb()), HasSubstr("/meshes/0/primitives/0: names vertex 6 of 6"));
  scene = seamed_square();
  scene.root["meshes"][0]["primitives"][0]["indices"] =
      scene.accessor(std::vector<std::uint8_t>{0, 1}, "SCALAR", 5121);
  EXPECT_THAT(complaint("a.glb", scene.glb()), HasSubstr("no whole number of triangles"));
  scene = seamed_square();
  scene.root["meshes"][0]["primitives"][0]["mode"] = 0;
  EXPECT_THAT(complaint("a.glb", scene.glb()), HasSubstr("the scene shows neither triangles nor lines"));
  scene = seamed_square();
  Json& lines = scene.root["meshes"][0]["primitives"][0];
  lines["mode"] = 1;
  lines["indices"] = scene.accessor(std::vector<std::uint8_t>{0, 1, 2}, "SCALAR", 5121);
  EXPECT_THAT(complaint("a.glb", scene.glb()), HasSubstr("3 indices are no whole number of lines"));
}

}  // namespace
}  // namespace bespoke
