#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "product/product_files.h"

namespace bespoke::test {

/// A glTF file in the making: its JSON, and the bytes of its one buffer.
class GltfScene {
 public:
  nlohmann::json root = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  std::string data;

  /// Appends values as an accessor with a view of its own; `more` are further members. Vectors begin at
  /// multiples of four bytes. Returns its number.
  template <class Value>
  int accessor(const std::vector<Value>& values, const std::string& type, int component,
               const nlohmann::json& more = nlohmann::json::object()) {
    const std::size_t size = type == "SCALAR" ? 1
                             : type == "MAT4" ? 16
                                              : static_cast<std::size_t>(type[3] - '0');
    align();
    const std::size_t begin = data.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
      data += bytes(values[i]);
      if (size > 1 && (i + 1) % size == 0) align();
    }
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", data.size() - begin}};
    const std::size_t stride = (sizeof(Value) * size + 3) / 4 * 4;
    if (size > 1 && stride != sizeof(Value) * size) view["byteStride"] = stride;
    root["bufferViews"].push_back(view);
    nlohmann::json own = {{"bufferView", root["bufferViews"].size() - 1},
                          {"componentType", component},
                          {"count", values.size() / size},
                          {"type", type}};
    own.update(more);
    root["accessors"].push_back(own);
    return static_cast<int>(root["accessors"].size()) - 1;
  }

  /// The JSON of a file whose buffer is `uri`.
  std::string gltf(const std::string& uri) {
    root["buffers"] = {{{"byteLength", data.size()}, {"uri", uri}}};
    return root.dump(1);
  }

  std::string glb() {
    align();
    root["buffers"] = {{{"byteLength", data.size()}}};
    std::string text = root.dump(1);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return "glTF" + bytes(2u) + bytes(static_cast<std::uint32_t>(28 + text.size() + data.size())) +
           bytes(static_cast<std::uint32_t>(text.size())) + "JSON" + text +
           bytes(static_cast<std::uint32_t>(data.size())) + std::string("BIN\0", 4) + data;
  }

 private:
  void align() { data.resize((data.size() + 3) / 4 * 4, '\0'); }
};

/// A triangle with normals, tangents, indices and a morph target that moves its second corner, shown by one
/// node: accessors 0 positions, 1 normals, 2 tangents, 3 the target's positions, 4 indices.
inline GltfScene morphing_triangle() {
  GltfScene scene;
  nlohmann::json attributes;
  attributes["POSITION"] = scene.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 2, 0}, "VEC3", 5126,
                                          {{"min", {0, 0, 0}}, {"max", {1, 2, 0}}});
  attributes["NORMAL"] = scene.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 5126);
  attributes["TANGENT"] =
      scene.accessor(std::vector<float>{1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, 1}, "VEC4", 5126);
  const int target = scene.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 0, 0}, "VEC3", 5126,
                                    {{"min", {0, 0, 0}}, {"max", {1, 0, 0}}});
  const int indices = scene.accessor(std::vector<std::uint16_t>{0, 1, 2}, "SCALAR", 5123);
  scene.root["meshes"] = {
      {{"primitives",
        {{{"attributes", attributes}, {"indices", indices}, {"targets", {{{"POSITION", target}}}}}}},
       {"name", "thing"}}};
  scene.root["nodes"] = {{{"mesh", 0}}};
  scene.root["scenes"] = {{{"nodes", {0}}}};
  return scene;
}

/// What a .glb holds.
struct GlbContent {
  explicit GlbContent(const std::string& content) {
    std::uint32_t length = 0;
    std::memcpy(&length, content.data() + 12, 4);
    text = content.substr(20, length);
    root = nlohmann::json::parse(text);
    data = content.substr(28 + length);
  }

  std::size_t begin(std::size_t accessor) const {
    const nlohmann::json& own = root["accessors"][accessor];
    const nlohmann::json& view = root["bufferViews"][own["bufferView"].get<std::size_t>()];
    return view.value("byteOffset", std::size_t{0}) + own.value("byteOffset", std::size_t{0});
  }

  /// Of an accessor of floats without gaps between its vectors.
  std::vector<float> floats(std::size_t accessor) const {
    const nlohmann::json& own = root["accessors"][accessor];
    const std::string type = own["type"];
    const auto components = static_cast<std::size_t>(type == "SCALAR" ? 1 : type[3] - '0');
    std::vector<float> values(components * own["count"].get<std::size_t>());
    std::memcpy(values.data(), data.data() + begin(accessor), 4 * values.size());
    return values;
  }

  std::string text;
  nlohmann::json root;
  std::string data;
};

}  // namespace bespoke::test
