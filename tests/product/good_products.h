#pragma once

#include <string>
#include <vector>

#include "bespoke/product/gltf/document/gltf_file.h"
#include "product/gltf_scene.h"

namespace bespoke::test {

struct GoodProduct {
  std::string name, content;
};

inline std::string ply_body(const std::string& format) {
  std::string text =
      "ply\nformat " + format +
      " 1.0\nelement vertex 40\nproperty float x\nproperty float y\nproperty double z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty list uchar short tags\n"
      "element face 38\nproperty list uchar int vertex_indices\nend_header\n";
  const bool big = format == "binary_big_endian", is_text = format == "ascii";
  for (int i = 0; i < 40; ++i) {
    if (is_text)
      text +=
          std::to_string(0.1 * i) + " 0.25 " + std::to_string(i * i) + " 0 0 1 1 " + std::to_string(i) + "\n";
    else
      text += bytes(0.1f * static_cast<float>(i), big) + bytes(0.25f, big) + bytes(1.0 * i * i, big) +
              bytes(0.0f, big) + bytes(0.0f, big) + bytes(1.0f, big) + bytes(std::uint8_t{1}) +
              bytes(static_cast<short>(i), big);
  }
  for (int i = 0; i < 38; ++i)
    text += is_text
                ? "3 " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) + "\n"
                : bytes(std::uint8_t{3}) + bytes(i, big) + bytes(i + 1, big) + bytes(i + 2, big);
  return text;
}

/// Skinned, morphing, shown twice, with a sparse accessor.
inline GltfScene gltf_scene() {
  GltfScene scene = morphing_triangle();
  scene.root["nodes"] = {{{"mesh", 0}, {"children", {1}}, {"translation", {0.5, 0, 0}}},
                         {{"mesh", 0}, {"rotation", {0, 0.6, 0, 0.8}}},
                         {{"mesh", 1}, {"skin", 0}}};
  scene.root["skins"] = {{{"joints", {1}}}};
  const int sparse = scene.accessor(std::vector<float>(12, 0.25f), "VEC3", 5126);
  const int at = scene.accessor(std::vector<std::uint16_t>{1, 3}, "SCALAR", 5123);
  const int with = scene.accessor(std::vector<float>(6, 2.0f), "VEC3", 5126);
  scene.root["accessors"][5]["sparse"] = {{"count", 2},
                                          {"indices", {{"bufferView", at}, {"componentType", 5123}}},
                                          {"values", {{"bufferView", with}}}};
  scene.root["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", sparse}}}}}}});
  return scene;
}

/// A small file of every kind.
inline std::vector<GoodProduct> good_products() {
  std::string obj = "mtllib a.mtl\r\no thing\n", off = "NOFF\n30 28 0\n", xyz, csv = "id,x,y,z\n";
  std::string stl = "solid s\n", binary_stl = std::string(80, 's') + bytes(20u);
  for (int i = 1; i <= 30; ++i) {
    const std::string x = std::to_string(0.5 * i) + " " + std::to_string(-1.0 * i * i) + " 1e-3";
    obj += "v " + x + "\nvn 0 0 1\nvt 0.5 0.5\n";
    off += x + " 0 0 1\n";
    xyz += x + "\n";
    csv += std::to_string(i) + "," + std::to_string(0.5 * i) + ",\"2\",3\n";
  }
  for (int i = 1; i <= 28; ++i) {
    obj += "f " + std::to_string(i) + "/1/1 " + std::to_string(i + 1) + "/2/" + std::to_string(i) +
           " -1/-1/-1\n";
    off += "3 " + std::to_string(i - 1) + " " + std::to_string(i) + " " + std::to_string(i + 1) +
           " 0.5 0.5 0.5\n";
  }
  for (int i = 0; i < 20; ++i) {
    stl += "facet normal 0 0 1\nouter loop\nvertex 0 0 " + std::to_string(i) +
           "\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    for (int k = 0; k < 12; ++k) binary_stl += bytes(static_cast<float>(i + k));
    binary_stl += bytes(std::uint16_t{1});
  }
  return {{"a.obj", obj},
          {"a.off", off},
          {"a.xyz", xyz},
          {"a.csv", csv},
          {"a.stl", stl + "endsolid s\n"},
          {"b.stl", binary_stl},
          {"a.ply", ply_body("ascii")},
          {"b.ply", ply_body("binary_little_endian")},
          {"c.ply", ply_body("binary_big_endian")},
          {"a.glb", gltf_scene().glb()},
          {"a.gltf", gltf_scene().gltf(data_uri_of("data:;base64,", gltf_scene().data))}};
}

}  // namespace bespoke::test
